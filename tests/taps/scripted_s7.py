"""The replies of an S7, byte by byte, so that a test can spoil them."""

from collections.abc import Callable

CONNECT, SETUP, READ = 0xE0, 0xF0, 0x04
_ACK_DATA = 3


def s7_frame_bytes(came: bytes) -> int:
    """Length of the first TPKT."""
    length = int.from_bytes(came[2:4], "big")
    return length if len(came) >= 4 and len(came) >= length else 0


def tpkt(pdu: bytes) -> bytes:
    return b"\x03\0" + (len(pdu) + 7).to_bytes(2, "big") + b"\x02\xf0\x80" + pdu


def reply(request: bytes, parameters: bytes, data: bytes = b"", error: bytes = b"\0\0") -> bytes:
    """An acknowledgement of the request in a frame."""
    sizes = len(parameters).to_bytes(2, "big") + len(data).to_bytes(2, "big")
    head = bytes([0x32, _ACK_DATA, 0, 0]) + request[11:13] + sizes + error
    return tpkt(head + parameters + data)


def items_of(frame: bytes) -> list[tuple[int, int, int, int]]:
    """Area, data block, first byte and number of bytes of each item of a read."""
    found = []
    for number in range(frame[18]):
        spec = frame[19 + 12 * number : 31 + 12 * number]
        start = int.from_bytes(spec[9:12], "big") // 8
        size, block = int.from_bytes(spec[4:6], "big"), int.from_bytes(spec[6:8], "big")
        found.append((spec[8], block, start, size))
    return found


def data_item(size: int, fill: int) -> bytes:
    return b"\xff\x04" + (8 * size).to_bytes(2, "big") + bytes([fill]) * size


def read_reply(frame: bytes, fill: int = 0) -> bytes:
    """The right reply of a PLC all of whose bytes are `fill`."""
    data = b""
    for _, _, _, size in items_of(frame):
        data += b"\0" * (len(data) % 2) + data_item(size, fill)
    return reply(frame, bytes([READ, frame[18]]), data)


class ScriptedS7:
    """Grants PDUs of `pdu_bytes`, and answers reads as `on_read` says."""

    def __init__(self, on_read: Callable[[bytes], bytes | None], pdu_bytes: int = 240) -> None:
        self.on_read = on_read
        self.pdu_bytes = pdu_bytes
        self.reads: list[bytes] = []
        self.called_tsaps: list[bytes] = []

    def __call__(self, frame: bytes) -> bytes | None:
        if frame[5] == CONNECT:
            at = frame.index(b"\xc2\x02")
            self.called_tsaps.append(frame[at + 2 : at + 4])
            return b"\x03\0\0\x0b\x06\xd0" + frame[8:10] + b"\0\x02\0"
        if frame[17] == SETUP:
            return reply(frame, frame[17:23] + self.pdu_bytes.to_bytes(2, "big"))
        self.reads.append(frame)
        return self.on_read(frame)
