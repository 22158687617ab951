"""One S7 connection: python-snap7's transport and protocol, with time-outs and codes of our own.

snap7's `Client` waits 5 s to connect whatever it is told, and gives the codes of single items
only as text; its layers below have what is needed.
"""

import logging
import struct
from dataclasses import dataclass
from typing import Any

from snap7.connection import ISOTCPConnection
from snap7.datatypes import S7Area as WireArea
from snap7.error import S7Error, S7PacketLostError, S7ProtocolError, S7TimeoutError
from snap7.s7protocol import S7Function, S7Protocol, get_return_code_description

from runglight.taps.device import DeviceLostError, WrongAnswerError
from runglight.taps.s7_address import S7Area
from runglight.taps.s7_reads import Item

PDU_BYTES = 960
"""What is asked for; an S7-300 grants 240, an S7-1500 all of it."""
_LEAST_PDU_BYTES = 64
_CONNECTION_TYPE_PG = 1
_LOCAL_TSAP = 0x0100
_GOOD = 0xFF
_LENGTH_IN_BITS = {0x03: False, 0x04: True, 0x05: True}
_STALE_REPLIES = 3
_WIRE = {
    S7Area.INPUT: WireArea.PE,
    S7Area.OUTPUT: WireArea.PA,
    S7Area.MEMORY: WireArea.MK,
    S7Area.DATA: WireArea.DB,
}

# What went wrong is told once, by us: without a handler Python would print it as well.
logging.getLogger("snap7").addHandler(logging.NullHandler())


class ItemRefusedError(WrongAnswerError):
    """The PLC refuses one item of a request."""

    def __init__(self, item: Item, code: int) -> None:
        self.item = item
        self.code = code
        super().__init__(
            f"the PLC answers '{get_return_code_description(code).lower()}' to {place_of(item)}"
        )


class RequestRefusedError(WrongAnswerError):
    """The PLC refuses a whole request: `code` is error class and code of the reply."""

    def __init__(self, code: int, text: str) -> None:
        self.code = code
        super().__init__(text)


def place_of(item: Item) -> str:
    """`bytes 0-26 of I`, for people."""
    area = f"DB{item.db}" if item.area is S7Area.DATA else item.area.value
    return f"bytes {item.start}-{item.start + item.count - 1} of {area}"


@dataclass(frozen=True, slots=True)
class S7Endpoint:
    """Where a CPU is, and how long one reply may take."""

    host: str
    port: int
    rack: int
    slot: int
    timeout_s: float


class S7Connection:
    """Reads, one after the other, by one thread."""

    def __init__(self, endpoint: S7Endpoint) -> None:
        self._timeout_s = endpoint.timeout_s
        self._protocol = S7Protocol()
        self._wire = ISOTCPConnection(
            endpoint.host,
            endpoint.port,
            local_tsap=_LOCAL_TSAP,
            remote_tsap=_CONNECTION_TYPE_PG << 8 | endpoint.rack << 5 | endpoint.slot,
        )
        self.pdu_bytes = PDU_BYTES

    def open(self) -> None:
        """Connects and agrees on the size of a PDU."""
        try:
            self._wire.connect(self._timeout_s)
        except (S7Error, OSError, struct.error) as error:
            raise DeviceLostError(f"no connection: {error}") from None
        try:
            reply = self._exchange(
                self._protocol.build_setup_communication_request(pdu_length=PDU_BYTES)
            )
        except WrongAnswerError as wrong:
            raise DeviceLostError(f"no agreement on the size of messages: {wrong}") from None
        granted = (reply.get("parameters") or {}).get("pdu_length", 0)
        if granted < _LEAST_PDU_BYTES:
            raise DeviceLostError(f"the PLC offers messages of {granted} bytes, which hold no data")
        self.pdu_bytes = min(granted, PDU_BYTES)

    def read(self, items: list[Item]) -> bytes:
        """The bytes of all items, read in one request."""
        reply = self._exchange(
            self._protocol.build_multi_read_request(
                [(_WIRE[item.area], item.db, item.start, item.count) for item in items]
            )
        )
        parameters = reply.get("parameters") or {}
        if parameters.get("function_code") != S7Function.READ_AREA:
            raise WrongAnswerError("the reply is to another kind of request")
        if parameters.get("item_count") != len(items):
            raise WrongAnswerError(
                f"the reply has {parameters.get('item_count')} of {len(items)} items"
            )
        return b"".join(_data_of(reply.get("raw_data", b""), items))

    def close(self) -> None:
        """Lets go of the connection. May be called twice."""
        self._wire.disconnect()

    def _exchange(self, request: bytes) -> dict[str, Any]:
        try:
            self._wire.send_data(request)
            for _ in range(_STALE_REPLIES):
                reply = self._protocol.parse_response(self._wire.receive_data())
                if reply["sequence"] == self._protocol.sequence:
                    return reply
        except S7TimeoutError:
            raise DeviceLostError(f"no reply in {self._timeout_s:g} s") from None
        except S7PacketLostError as error:
            raise WrongAnswerError(str(error)) from None
        except S7ProtocolError as error:
            if error.error_code:
                raise RequestRefusedError(error.error_code, f"the PLC answers '{error}'") from None
            raise WrongAnswerError(f"the reply makes no sense: {error}") from None
        except (S7Error, OSError) as error:
            raise DeviceLostError(str(error)) from None
        except (struct.error, IndexError, ValueError) as error:
            raise WrongAnswerError(f"the reply makes no sense: {error}") from None
        raise WrongAnswerError("the replies are to other requests")


def _data_of(raw: bytes, items: list[Item]) -> list[bytes]:
    found: list[bytes] = []
    offset = 0
    for item in items:
        head = raw[offset : offset + 4]
        if len(head) < 4:
            raise WrongAnswerError(f"the reply ends before {place_of(item)}")
        if head[0] != _GOOD:
            raise ItemRefusedError(item, head[0])
        length = int.from_bytes(head[2:4], "big")
        if _LENGTH_IN_BITS.get(head[1], False):
            length //= 8
        data = raw[offset + 4 : offset + 4 + length]
        if length != item.count or len(data) != item.count:
            raise WrongAnswerError(
                f"the reply has {len(data)} bytes for {place_of(item)} instead of {item.count}"
            )
        found.append(data)
        offset += 4 + length + length % 2
    return found
