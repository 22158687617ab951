"""Is this the reply to that request? Modbus Messaging on TCP/IP, 3.1.3; Application Protocol, 6."""

from dataclasses import dataclass

from runglight.taps.modbus_names import IS_BITS, Area

FUNCTION = {Area.COILS: 1, Area.INPUTS: 2, Area.HOLDING: 3, Area.INPUT_REGISTERS: 4}
_EXCEPTION = 0x80
_HEADER = 7
_AHEAD_OF_DATA = 9


@dataclass(frozen=True, slots=True)
class Request:
    """One read: `count` addresses from `start`."""

    area: Area
    start: int
    count: int

    @property
    def reply_bytes(self) -> int:
        """Length of the data in a right reply."""
        return -(-self.count // 8) if self.area in IS_BITS else 2 * self.count


def fault_of(frame: bytes, request: Request, unit: int, transaction: int) -> str | None:
    """What is wrong with a reply as far as it has come; None where nothing is."""
    if len(frame) < _AHEAD_OF_DATA:
        return None
    length = int.from_bytes(frame[4:6], "big")
    function = FUNCTION[request.area]
    refused = frame[_HEADER] == function | _EXCEPTION
    whole = request.reply_bytes
    checks = (
        (frame[2:4] != b"\0\0", "the reply is not Modbus"),
        (int.from_bytes(frame[:2], "big") != transaction, "the reply is to another request"),
        (frame[6] != unit, f"unit {frame[6]} answered instead of unit {unit}"),
        (refused and length != 3, "the exception reply has a wrong length"),
        (
            not refused and frame[_HEADER] != function,
            f"the reply has function code {frame[_HEADER]} instead of {function}",
        ),
        (
            not refused and (frame[8] != whole or length != whole + 3),
            f"the reply has {frame[8]} bytes instead of {whole}",
        ),
    )
    return next((fault for is_wrong, fault in checks if is_wrong), None)


def is_whole(frame: bytes) -> bool:
    """Whether the frame has come to its end."""
    return len(frame) >= _AHEAD_OF_DATA and len(frame) >= int.from_bytes(frame[4:6], "big") + 6


def data_of(frame: bytes, request: Request) -> bytes:
    """The data of a whole reply without fault."""
    return frame[_AHEAD_OF_DATA : _AHEAD_OF_DATA + request.reply_bytes]
