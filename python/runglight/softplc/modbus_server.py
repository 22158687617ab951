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
from runglight.softplc.server import Look

# Whatever a client does wrong, it is told; the terminal is not for it.
logging.getLogger("pymodbus").addHandler(logging.NullHandler())

_TABLE_READ_BY = {1: Table.COILS, 2: Table.INPUTS, 4: Table.INPUT_REGISTERS}
"""Modbus function codes; all other readers read holding registers."""


class ModbusServer:
    """Answers any unit number; reads only: a write is answered by "illegal function"."""

    def __init__(self, symbols: Sequence[Symbol], look: Look) -> None:
        self._layout = ModbusLayout(symbols)
        self._look = look
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
        _address: int,
        _count: int,
        registers: list[int],
        values: list[int] | list[bool] | None,
    ) -> ExcCodes | None:
        """Called by pymodbus within every request: fills its registers with the scan of now."""
        if values is not None:
            return ExcCodes.ILLEGAL_FUNCTION
        table = self._layout.tables(self._look())[_TABLE_READ_BY.get(function_code, Table.HOLDING)]
        registers[: len(table)] = table
        return None


def _bits(table: Table) -> SimData:
    return SimData(0, count=REGISTERS[table] * 16, values=False, datatype=DataType.BITS)


def _words(table: Table) -> SimData:
    return SimData(0, count=REGISTERS[table], values=0, datatype=DataType.REGISTERS)
