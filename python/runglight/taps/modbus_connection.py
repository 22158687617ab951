"""One Modbus TCP connection, by pymodbus, with every reply checked before it counts."""

import asyncio
import logging
import os
from collections.abc import Awaitable
from dataclasses import dataclass
from typing import Any, TypeVar

from pymodbus.client import AsyncModbusTcpClient
from pymodbus.exceptions import ModbusException

from runglight.taps.device import DeviceLostError, WrongAnswerError
from runglight.taps.modbus_frame import Request, data_of, fault_of, is_whole
from runglight.taps.modbus_names import Area

Result = TypeVar("Result")

ILLEGAL_FUNCTION = 1
ILLEGAL_ADDRESS = 2
ILLEGAL_VALUE = 3
# Modbus Application Protocol V1.1b3, 7.
_EXCEPTIONS = {
    ILLEGAL_FUNCTION: "illegal function",
    ILLEGAL_ADDRESS: "illegal data address",
    ILLEGAL_VALUE: "illegal data value",
    4: "device failure",
    5: "acknowledge",
    6: "device busy",
    8: "memory parity error",
    10: "gateway path unavailable",
    11: "gateway target device failed to respond",
}
_CLOSED = "the connection was closed by the other side"

# What went wrong is told once, by us: without a handler Python would print it as well.
logging.getLogger("pymodbus").addHandler(logging.NullHandler())


class RefusedError(WrongAnswerError):
    """The device answered a request with an exception."""

    def __init__(self, request: Request, code: int) -> None:
        self.code = code
        said = _EXCEPTIONS.get(code, f"exception {code}")
        last = request.start + request.count - 1
        super().__init__(
            f"the device answers '{said}' to {request.area.value}={request.start}-{last}"
        )


@dataclass(frozen=True, slots=True)
class ModbusEndpoint:
    """Where a device is, and how long one reply may take."""

    host: str
    port: int
    unit: int
    timeout_s: float


class ModbusConnection:
    """Reads, one after the other. Has to be made in the event loop that uses it."""

    def __init__(self, endpoint: ModbusEndpoint) -> None:
        self._unit = endpoint.unit
        self._timeout_s = endpoint.timeout_s
        self._transaction = 0
        self._request: Request | None = None
        self._data: bytes | None = None
        self._fault: DeviceLostError | WrongAnswerError | None = None
        self._reader: asyncio.Task[Any] | None = None
        self._refused_because: str | None = None
        self._client = AsyncModbusTcpClient(
            endpoint.host,
            port=endpoint.port,
            timeout=endpoint.timeout_s,
            retries=0,
            reconnect_delay=0,
            trace_packet=self._see_packet,
            trace_connect=self._see_connection,
        )
        # pymodbus only logs why it could not connect.
        self._create = self._client.ctx.call_create
        self._client.ctx.call_create = self._create_telling

    async def open(self) -> None:
        """Connects; DeviceLostError says why it does not."""
        self._refused_because = None
        if not await _heeding_cancellation(self._client.connect()):
            raise DeviceLostError(
                self._refused_because or f"no connection in {self._timeout_s:g} s"
            )

    async def read(self, request: Request) -> bytes:
        """The data of the reply: bits packed from the lowest, or words, high byte first."""
        # pymodbus would connect anew by itself, and the gap would go unseen.
        if not self._client.connected:
            raise DeviceLostError(_CLOSED)
        self._request, self._data, self._fault = request, None, None
        self._reader = asyncio.current_task()
        try:
            reply = await _heeding_cancellation(self._ask(request))
        except ModbusException:
            raise DeviceLostError(f"no reply in {self._timeout_s:g} s") from None
        except asyncio.CancelledError:
            task = self._reader
            if self._fault is None or task is None or task.uncancel():
                raise
            raise self._fault from None
        finally:
            self._request = self._reader = None
        if reply.isError():
            raise RefusedError(request, reply.exception_code)
        if self._data is None:
            raise WrongAnswerError("the reply has no data")
        return self._data

    def close(self) -> None:
        """Lets go of the connection. May be called twice."""
        self._client.close()

    def _ask(self, request: Request) -> Any:
        client = self._client
        read = {
            Area.COILS: client.read_coils,
            Area.INPUTS: client.read_discrete_inputs,
            Area.HOLDING: client.read_holding_registers,
            Area.INPUT_REGISTERS: client.read_input_registers,
        }[request.area]
        return read(request.start, count=request.count, device_id=self._unit)

    def _see_packet(self, sending: bool, data: bytes) -> bytes:
        """Sees all that comes before pymodbus takes it apart, and hides what is no answer.

        pymodbus waits in vain after a reply of another unit, and raises inside the transport on
        one it cannot decode.
        """
        if sending:
            self._transaction = int.from_bytes(data[:2], "big")
            return data
        request = self._request
        if request is None or self._fault is not None:
            return b""
        fault = fault_of(data, request, self._unit, self._transaction)
        if fault is not None:
            self._interrupt(WrongAnswerError(fault))
            return b""
        if is_whole(data):
            self._data = data_of(data, request)
        return data

    def _see_connection(self, connected: bool) -> None:
        if not connected:
            self._interrupt(DeviceLostError(_CLOSED))

    def _interrupt(self, fault: DeviceLostError | WrongAnswerError) -> None:
        """Ends the wait for a reply at once."""
        if self._reader is not None and self._fault is None:
            self._fault = fault
            self._reader.cancel()

    async def _create_telling(self) -> Any:
        try:
            return await self._create()
        except OSError as error:
            # asyncio writes the address where the system says why.
            why = os.strerror(error.errno).lower() if error.errno else str(error)
            self._refused_because = f"no connection: {why}"
            raise


async def _heeding_cancellation(waiting: Awaitable[Result]) -> Result:
    """Cancelled where it was asked to be, even at the moment at which the reply comes.

    pymodbus waits with `asyncio.wait_for`, which forgets such a cancellation before Python 3.12
    (CPython issue 86296): a tap scanning without pause could not be closed.
    """
    task = asyncio.current_task()
    assert task is not None
    before = task.cancelling()
    result = await waiting
    if task.cancelling() > before:
        raise asyncio.CancelledError
    return result
