"""What is written at once: the columns of several batches, packed.

Times are kept as differences, every column in the narrowest integers that hold it, and all of it
is deflated with its check sum: 2,000 changes and 600 scans, a fifth of a second of a fast machine,
are a few kilobytes and one row of the database.
"""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from dataclasses import dataclass

import msgspec
import numpy as np
import numpy.typing as npt

from runglight.taps.base import Batch, ClockStep, Gap, Mark

Integers = npt.NDArray[np.int64]
COMPRESSION_LEVEL = 1
"""The fastest: it halves what an edge box's memory card must take, at 1 % of a core."""
_WIDTHS = ("<i1", "<i2", "<i4", "<i8")


class DamagedBlockError(Exception):
    """Bytes that are no block; the text says why."""


@dataclass(frozen=True, slots=True)
class Block:
    """Rows, scans and marks up to `until_ns`; signals by their number in the recording."""

    until_ns: int
    time_ns: Integers
    signal: Integers
    value: Integers
    scan_ns: Integers
    marks: tuple[Mark, ...] = ()

    @classmethod
    def of(cls, batches: Sequence[Batch], number_of: Sequence[int]) -> Block:
        """Joins batches; `number_of` turns indices of the tap into numbers of the recording."""
        indices = np.concatenate([batch.signal_index for batch in batches])
        return cls(
            until_ns=max(batch.until_ns for batch in batches),
            time_ns=np.concatenate([batch.time_ns for batch in batches]),
            signal=np.asarray(number_of, np.int64)[indices] if len(indices) else _NONE,
            value=np.concatenate([batch.value for batch in batches]),
            scan_ns=np.concatenate([batch.scan_ns for batch in batches]),
            marks=tuple(mark for batch in batches for mark in batch.marks),
        )


_NONE: Integers = np.empty(0, np.int64)


class PackedMark(msgspec.Struct, array_like=True):
    """A gap (with its end and reason) or a step of the clock (with its size)."""

    time_ns: int
    end_ns: int | None
    step_ns: int | None
    reason: str

    @classmethod
    def of(cls, mark: Mark) -> PackedMark:
        """A mark as it is written."""
        if isinstance(mark, Gap):
            # A reason may quote an operating system that does not speak UTF-8.
            reason = mark.reason.encode("utf-8", "replace").decode()
            return cls(mark.start_ns, mark.end_ns, None, reason)
        return cls(mark.time_ns, None, mark.step_ns, "")

    def mark(self) -> Mark:
        """The mark that was written."""
        if self.end_ns is not None:
            return Gap(self.time_ns, self.end_ns, self.reason)
        return ClockStep(self.time_ns, self.step_ns or 0)


class _Packed(msgspec.Struct, array_like=True):
    until_ns: int
    time_first: int
    time_steps: tuple[str, bytes]
    signal: tuple[str, bytes]
    value: tuple[str, bytes]
    scan_first: int
    scan_steps: tuple[str, bytes]
    marks: list[PackedMark]


def pack(block: Block) -> bytes:
    """A block as bytes that know whether they are whole."""
    time_first, time_steps = differences(block.time_ns)
    scan_first, scan_steps = differences(block.scan_ns)
    packed = _Packed(
        until_ns=block.until_ns,
        time_first=time_first,
        time_steps=_column(time_steps),
        signal=_column(block.signal),
        value=_column(block.value),
        scan_first=scan_first,
        scan_steps=_column(scan_steps),
        marks=[PackedMark.of(mark) for mark in block.marks],
    )
    return zlib.compress(msgspec.msgpack.encode(packed), COMPRESSION_LEVEL)


def unpack(content: bytes) -> Block:
    """The block that was packed; DamagedBlockError where the bytes are not whole."""
    try:
        packed = msgspec.msgpack.decode(zlib.decompress(content), type=_Packed)
        block = Block(
            until_ns=packed.until_ns,
            time_ns=summed(packed.time_first, _array(packed.time_steps)),
            signal=_array(packed.signal),
            value=_array(packed.value),
            scan_ns=summed(packed.scan_first, _array(packed.scan_steps)),
            marks=tuple(mark.mark() for mark in packed.marks),
        )
    except (zlib.error, msgspec.DecodeError, ValueError) as error:
        raise DamagedBlockError(str(error)) from None
    if not len(block.time_ns) == len(block.signal) == len(block.value):
        raise DamagedBlockError("its columns differ in length")
    return block


def differences(times: Integers) -> tuple[int, Integers]:
    """The first time, and for every time the step from the one before (the first's is 0)."""
    if not len(times):
        return 0, times
    return int(times[0]), np.diff(times, prepend=times[:1])


def summed(first: int, steps: Integers) -> Integers:
    """Times from the first one and the steps."""
    return np.cumsum(steps, dtype=np.int64) + np.int64(first)


def narrowest(column: Integers) -> npt.NDArray[np.signedinteger]:
    """The same numbers in the narrowest integers that hold them."""
    if not len(column):
        return column.astype("<i1")
    low, high = int(column.min()), int(column.max())
    width = next(w for w in _WIDTHS if np.iinfo(w).min <= low and high <= np.iinfo(w).max)
    return column.astype(width)


def _column(column: Integers) -> tuple[str, bytes]:
    narrow = narrowest(column)
    return narrow.dtype.str.replace("|", "<"), narrow.tobytes()


def _array(column: tuple[str, bytes]) -> Integers:
    width, content = column
    if width not in _WIDTHS:
        raise ValueError(f"a column of type {width!r}")
    return np.frombuffer(content, width).astype(np.int64)
