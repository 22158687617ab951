"""Writes outputs over Modbus TCP. Nothing else in runglight writes to a machine."""

from collections.abc import Iterator, Sequence

from pymodbus.client import AsyncModbusTcpClient
from pymodbus.exceptions import ModbusException

from runglight.errors import InputError
from runglight.taps.device import DeviceLostError
from runglight.taps.modbus_connection import ModbusEndpoint
from runglight.taps.modbus_names import SINGULAR, Area

Write = tuple[Area, int, int]
"""Area, number and value."""

WRITABLE = (Area.COILS, Area.HOLDING)
MOST_AT_ONCE = 100


class ModbusWriter:
    """One connection, for writes alone."""

    def __init__(self, endpoint: ModbusEndpoint) -> None:
        self._endpoint = endpoint
        self._client: AsyncModbusTcpClient | None = None

    async def write(self, writes: Sequence[Write]) -> None:
        """Writes in the order given; neighbours written together are one request.

        Raises DeviceLostError where the device does not answer, and InputError where it refuses.
        """
        try:
            client = await self._connected()
            for run in _runs(writes):
                await self._write(client, run)
        except (ModbusException, OSError, TimeoutError) as error:
            self.close()
            raise DeviceLostError(
                f"no reply to a write in {self._endpoint.timeout_s:g} s"
            ) from error

    def close(self) -> None:
        """Lets go of the connection. May be called twice."""
        if self._client is not None:
            self._client.close()
            self._client = None

    async def _connected(self) -> AsyncModbusTcpClient:
        if self._client is None or not self._client.connected:
            self.close()
            self._client = AsyncModbusTcpClient(
                self._endpoint.host,
                port=self._endpoint.port,
                timeout=self._endpoint.timeout_s,
                retries=0,
                reconnect_delay=0,
            )
            if not await self._client.connect():
                self.close()
                raise DeviceLostError("no connection to write")
        return self._client

    async def _write(self, client: AsyncModbusTcpClient, run: Sequence[Write]) -> None:
        area, first, _ = run[0]
        values = [value for _, _, value in run]
        unit = self._endpoint.unit
        if area is Area.COILS:
            reply = await client.write_coils(first, [bool(v) for v in values], device_id=unit)
        else:
            reply = await client.write_registers(
                first, [value & 0xFFFF for value in values], device_id=unit
            )
        if reply.isError():
            raise InputError(
                f"modbus://{self._endpoint.host}:{self._endpoint.port}: the device refuses a write "
                f"to {SINGULAR[area]} {first} (exception {reply.exception_code}); is it an output "
                "of a PLC that lets itself be written?"
            )


def _runs(writes: Sequence[Write]) -> Iterator[list[Write]]:
    """Neighbours together: a machine with two valves gets them in one moment."""
    left = list(writes)
    while left:
        run = [left.pop(0)]
        while len(run) < MOST_AT_ONCE:
            ahead = next((w for w in left if w[:2] == (run[-1][0], run[-1][1] + 1)), None)
            behind = next((w for w in left if w[:2] == (run[0][0], run[0][1] - 1)), None)
            if ahead is not None:
                run.append(ahead)
                left.remove(ahead)
            elif behind is not None:
                run.insert(0, behind)
                left.remove(behind)
            else:
                break
        yield run
