"""A soft PLC's Modbus TCP server, made of pymodbus'."""

import logging
from collections.abc import Sequence

from pymodbus.constants import ExcCodes
from pymodbus.server import ModbusTcpServer
from pymodbus.simulator import DataType, SimData, SimDevice

from runglight.plants.symbols import Symbol
from runglight.softplc.listening import check_free
from runglight.softplc.modbus_layout import REGISTERS, ModbusLayout, Table
from runglight.softplc.serve_url import ServeUrl
from runglight.softplc.server import Look, Write

# Whatever a client does wrong, it is told; the terminal is not for it.
logging.getLogger("pymodbus").addHandler(logging.NullHandler())

_WRITES_COILS = {5, 15}
_TABLE_READ_BY = {1: Table.COILS, 2: Table.INPUTS, 4: Table.INPUT_REGISTERS}
"""Modbus function codes; all other readers read holding registers."""


class ModbusServer:
    """Answers any unit number.

    Coils can be written where the plant has no PLC of its own, and those alone that are its
    outputs; every other write is answered by "illegal function" or "illegal data address".
    """

    def __init__(self, symbols: Sequence[Symbol], look: Look, write: Write | None = None) -> None:
        self._layout = ModbusLayout(symbols)
        self._look = look
        self._write = write
        self._server: ModbusTcpServer | None = None
        self._clients = 0
        self.symbols = self._layout.symbols
        self.tap_query = self._layout.tap_query

    @property
    def clients(self) -> int:
        """How many are connected."""
        return self._clients

    async def start(self, url: ServeUrl) -> int:
        """Listens; the port."""
        host = check_free(url)
        server = ModbusTcpServer(
            SimDevice(
                0,
                (
                    [_bits(Table.COILS)],
                    [_bits(Table.INPUTS)],
                    [_words(Table.HOLDING)],
                    [_words(Table.INPUT_REGISTERS)],
                ),
                action=self._answer,
            ),
            address=(host, url.port),
            trace_connect=self._count,
        )
        await server.serve_forever(background=True)
        self._server = server
        port: int = server.transport.sockets[0].getsockname()[1]  # type: ignore[attr-defined]
        return port

    async def stop(self) -> None:
        """Hangs up on every client and listens no more."""
        server, self._server = self._server, None
        if server is not None:
            await server.shutdown()  # type: ignore[no-untyped-call]

    def _count(self, connected: bool) -> None:
        self._clients += 1 if connected else -1

    async def _answer(
        self,
        function_code: int,
        _start_address: int,
        address: int,
        _count: int,
        registers: list[int],
        values: list[int] | list[bool] | None,
    ) -> ExcCodes | None:
        """Called by pymodbus within every request: fills its registers with the scan of now."""
        if values is not None:
            refusal = self._write_coils(function_code, address, values)
            if refusal is not None:
                return refusal
        read_by = Table.COILS if values is not None else _TABLE_READ_BY.get(function_code)
        table = self._layout.tables(self._look())[read_by or Table.HOLDING]
        registers[: len(table)] = table
        return None

    def _write_coils(
        self, function_code: int, address: int, values: list[int] | list[bool]
    ) -> ExcCodes | None:
        if self._write is None or function_code not in _WRITES_COILS:
            return ExcCodes.ILLEGAL_FUNCTION
        outputs = self._layout.outputs_at(range(address, address + len(values)))
        if None in outputs:
            return ExcCodes.ILLEGAL_ADDRESS
        self._write(
            [
                (output, int(value))
                for output, value in zip(outputs, values, strict=True)
                if output is not None
            ]
        )
        return None


def _bits(table: Table) -> SimData:
    return SimData(0, count=REGISTERS[table] * 16, values=False, datatype=DataType.BITS)


def _words(table: Table) -> SimData:
    return SimData(0, count=REGISTERS[table], values=0, datatype=DataType.REGISTERS)
