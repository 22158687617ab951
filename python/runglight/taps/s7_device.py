"""An S7 PLC as a scanner sees it: few requests, one image, a signal per bit."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from runglight.errors import InputError
from runglight.taps.base import Answer, TapSignal
from runglight.taps.device import DeviceLostError
from runglight.taps.ranges import spelled
from runglight.taps.s7_address import S7Address, S7Area
from runglight.taps.s7_connection import (
    ItemRefusedError,
    RequestRefusedError,
    S7Connection,
    S7Endpoint,
)
from runglight.taps.s7_reads import Item, requests

_CLASS_OF = {S7Area.INPUT: "input", S7Area.OUTPUT: "output"}
_OPTION_OF = {S7Area.INPUT: "pe", S7Area.OUTPUT: "pa", S7Area.MEMORY: "mk"}
# Access denied, invalid address, type not supported, type inconsistent, no such object.
_NEVER_WORKS = {0x03, 0x05, 0x06, 0x07, 0x0A}
_FUNCTION_NOT_AVAILABLE = 0x8104


class S7Device:
    """See `runglight.taps.device.BlockingDevice`."""

    def __init__(
        self,
        source: str,
        endpoint: S7Endpoint,
        items: Sequence[Item],
    ) -> None:
        self._source = source
        self._endpoint = endpoint
        self._items = list(items)
        self.signals = [
            _signal(S7Address(item.area, byte, bit, db=item.db))
            for item in self._items
            for byte in range(item.start, item.start + item.count)
            for bit in range(8)
        ]
        self._connection: S7Connection | None = None
        self._requests: list[list[Item]] = []
        self._answered = False

    def connect(self) -> None:
        """Connects; the first time, finds out whether the PLC has all that is asked for."""
        connection = self._open()
        self._requests = requests(self._items, connection.pdu_bytes)
        if self._answered:
            return
        refused = self._refused()
        if refused:
            raise InputError(self._refusal(refused))
        self._answered = True

    def read(self) -> bytes:
        """All bytes: inputs come before outputs, memory and data blocks."""
        connection = self._connection
        if connection is None:
            raise DeviceLostError("not connected")
        if len(self._requests) == 1:
            return connection.read(self._requests[0])
        return b"".join([connection.read(request) for request in self._requests])

    def values(self, image: bytes) -> npt.NDArray[np.int64]:
        """The value of every bit."""
        bits = np.unpackbits(np.frombuffer(image, np.uint8), bitorder="little")
        return bits.astype(np.int64)

    def check(self) -> list[Answer]:
        """Asks for every signal once."""
        connection = self._open()
        refused = self._refused()
        answers: list[Answer] = []
        signals = iter(self.signals)
        for item in self._items:
            good = [byte for byte in _bytes(item) if (item.area, item.db, byte) not in refused]
            parts = [_item(item, byte) for byte in good]
            data = {
                part.start: value
                for request in requests(_joined(parts), connection.pdu_bytes)
                for part, value in zip(
                    [_item(one, byte) for one in request for byte in _bytes(one)],
                    connection.read(request),
                    strict=True,
                )
            }
            for byte in _bytes(item):
                error = refused.get((item.area, item.db, byte))
                for bit in range(8):
                    value = None if error else data[byte] >> bit & 1
                    answers.append(Answer(next(signals), value, error))
        return answers

    def close(self) -> None:
        """Lets go of the connection."""
        if self._connection is not None:
            self._connection.close()
            self._connection = None

    def _open(self) -> S7Connection:
        self.close()
        self._connection = S7Connection(self._endpoint)
        self._connection.open()
        return self._connection

    def _refused(self) -> dict[tuple[S7Area, int, int], str]:
        """The bytes the PLC does not give, and why."""
        assert self._connection is not None
        refused: dict[tuple[S7Area, int, int], str] = {}
        for item in self._items:
            for (part,) in requests([item], self._connection.pdu_bytes):
                self._find_refused(part, refused)
        return refused

    def _find_refused(self, item: Item, refused: dict[tuple[S7Area, int, int], str]) -> None:
        refusal = self._refusal_of(item)
        if refusal is None:
            return
        ends = (item.start, item.start + item.count - 1)
        if item.count == 1 or all(self._refusal_of(_item(item, end)) for end in ends):
            for byte in _bytes(item):
                refused[item.area, item.db, byte] = refusal
            return
        half = item.count // 2
        self._find_refused(Item(item.area, item.db, item.start, half), refused)
        self._find_refused(Item(item.area, item.db, item.start + half, item.count - half), refused)

    def _refusal_of(self, item: Item) -> str | None:
        assert self._connection is not None
        try:
            self._connection.read([item])
        except ItemRefusedError as refusal:
            if refusal.code in _NEVER_WORKS:
                return str(refusal)
            raise
        except RequestRefusedError as refusal:
            if refusal.code != _FUNCTION_NOT_AVAILABLE:
                raise
            raise InputError(
                f"{self._source}: the PLC refuses to be read; permit access with PUT/GET "
                "in the protection settings of the CPU, and load them into it"
            ) from None
        return None

    def _refusal(self, refused: dict[tuple[S7Area, int, int], str]) -> str:
        missing: list[str] = []
        mend: list[str] = []
        for area, db in dict.fromkeys((area, db) for area, db, _ in refused):
            option = _OPTION_OF.get(area, f"db{db}")
            asked = [
                byte
                for item in self._items
                if (item.area, item.db) == (area, db)
                for byte in _bytes(item)
            ]
            missing.append(
                f"{option} {spelled(byte for byte in asked if (area, db, byte) in refused)}"
            )
            rest = spelled(byte for byte in asked if (area, db, byte) not in refused)
            mend.append(f"write {option}={rest}" if rest else f"leave out {option}")
        blocks = any(area is S7Area.DATA for area, _, _ in refused)
        optimised = ", or switch off 'optimized block access' of the data block" if blocks else ""
        return (
            f"{self._source}: the PLC does not give {' and '.join(missing)} "
            f"({next(iter(refused.values()))}); {' and '.join(mend)}{optimised}"
        )


def _signal(address: S7Address) -> TapSignal:
    name = str(address)
    return TapSignal(name, name, "BOOL", _CLASS_OF.get(address.area, "memory"))


def _bytes(item: Item) -> range:
    return range(item.start, item.start + item.count)


def _item(item: Item, byte: int) -> Item:
    return Item(item.area, item.db, byte, 1)


def _joined(parts: list[Item]) -> list[Item]:
    joined: list[Item] = []
    for part in parts:
        last = joined[-1] if joined else None
        if last is not None and last.start + last.count == part.start:
            joined[-1] = Item(last.area, last.db, last.start, last.count + part.count)
        else:
            joined.append(part)
    return joined
