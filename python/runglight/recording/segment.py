"""Sealed segments: what leaves the tail, for good and for every tool that reads Parquet.

A segment is a change log in Parquet (with its gaps and scan interval, as `runglight export` writes
it) and, beside it, its scans and marks as NumPy arrays with the check sum of the Parquet file.
"""

from __future__ import annotations

import io
import zipfile
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import msgspec
import numpy as np

from runglight import _engine
from runglight.errors import InputError
from runglight.log.changelog import Log
from runglight.log.options import ReadOptions
from runglight.recording.block import Block, Integers, PackedMark, differences, narrowest, summed
from runglight.recording.durable import write_durably
from runglight.recording.layout import changes_file, scans_file
from runglight.recording.stretch import Stretch, gaps_of
from runglight.recording.tail import read_tail

_CHUNK_BYTES = 1 << 20


class _About(msgspec.Struct):
    """What stands beside the arrays of `NNNNNN.scans.npz`."""

    start_ns: int
    until_ns: int
    rows: int
    changes_crc32: int
    scan_interval_ns: int | None
    marks: list[PackedMark]


@dataclass(frozen=True, slots=True)
class SegmentHead:
    """What is known of a segment before its changes are read."""

    number: int
    start_ns: int
    until_ns: int
    rows: int


def seal(
    directory: Path, number: int, last_block: int, names: Sequence[str], interval_ns: int | None
) -> None:
    """Writes the tail's blocks up to one as a segment; both files are on the disk afterwards."""
    _, blocks = read_tail(directory, up_to_block=last_block)
    write_segment(directory, number, [block for _, block in blocks], names, interval_ns)


def write_segment(
    directory: Path,
    number: int,
    blocks: Sequence[Block],
    names: Sequence[str],
    interval_ns: int | None,
) -> None:
    """Writes blocks as a segment, over what a killed recorder may have left of it."""
    stretch = Stretch.of(blocks)
    changes = changes_file(directory, number)
    changes.parent.mkdir(exist_ok=True)
    if len(stretch.time_ns):
        Log.from_columns(
            stretch.time_ns,
            stretch.signal.astype(np.uint32),
            stretch.value,
            names,
            scan_interval_s=interval_ns / 1e9 if interval_ns else None,
            gaps=gaps_of(stretch.marks),
        ).write(changes)
    else:
        changes.unlink(missing_ok=True)
    about = _About(
        start_ns=stretch.start_ns,
        until_ns=stretch.until_ns,
        rows=len(stretch.time_ns),
        changes_crc32=_crc32(changes) if len(stretch.time_ns) else 0,
        scan_interval_ns=stretch.scan_interval_ns,
        marks=[PackedMark.of(mark) for mark in stretch.marks],
    )
    first, steps = differences(stretch.scan_ns)
    packed = io.BytesIO()
    np.savez_compressed(
        packed,
        scan_first_ns=np.int64(first),
        scan_step_ns=narrowest(steps),
        about=np.frombuffer(msgspec.json.encode(about), np.uint8),
    )
    write_durably(scans_file(directory, number), packed.getvalue())


def read_head(directory: Path, number: int) -> SegmentHead:
    """Times and size of a segment; InputError where it is damaged."""
    about, _ = _beside(directory, number, scans=False)
    return SegmentHead(number, about.start_ns, about.until_ns, about.rows)


def read_segment(directory: Path, number: int, numbers: dict[str, int], *, scans: bool) -> Stretch:
    """A segment's columns; `numbers` are those of the recording's signals by name.

    Without `scans` their times are left on the disk: a day of them can be gigabytes.
    """
    about, scan_ns = _beside(directory, number, scans=scans)
    path = changes_file(directory, number)
    if about.rows == 0:
        time_ns: Integers = np.empty(0, np.int64)
        signal, value = time_ns, time_ns
    else:
        log = _read_changes(path, about)
        unknown = next((name for name in log.signals if name not in numbers), None)
        if unknown is not None:
            raise _damaged(path, f"its signal {unknown!r} is not in recording.json")
        time_ns, index, value = log.columns()
        signal = np.array([numbers[name] for name in log.signals], np.int64)[index]
    return Stretch(
        start_ns=about.start_ns,
        until_ns=about.until_ns,
        time_ns=time_ns,
        signal=signal,
        value=value,
        scan_ns=scan_ns,
        marks=tuple(mark.mark() for mark in about.marks),
        scan_interval_ns=about.scan_interval_ns,
    )


def _read_changes(path: Path, about: _About) -> _engine.ChangeLog:
    try:
        whole = _crc32(path) == about.changes_crc32
    except FileNotFoundError:
        raise _missing(path) from None
    if not whole:
        raise _damaged(path, "its check sum is wrong")
    options = ReadOptions(
        format="parquet",
        time_column="time",
        signal_columns=["signal"],
        value_column="value",
        reorder_s=0.0,
    )
    log = _engine.read_log(str(path), options.to_json())
    if len(log) != about.rows:
        raise _damaged(path, f"it has {len(log):,} rows, {about.rows:,} were written")
    return log


def _beside(directory: Path, number: int, *, scans: bool) -> tuple[_About, Integers]:
    path = scans_file(directory, number)
    scan_ns: Integers = np.empty(0, np.int64)
    try:
        # The file is opened here, so that it is closed whatever is in it.
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as arrays:
            about = msgspec.json.decode(arrays["about"].tobytes(), type=_About)
            if scans:
                steps = arrays["scan_step_ns"].astype(np.int64)
                scan_ns = summed(int(arrays["scan_first_ns"]), steps)
    except FileNotFoundError:
        raise _missing(path) from None
    except (
        *(ValueError, TypeError, KeyError, EOFError, NotImplementedError, RuntimeError),
        *(OverflowError, SyntaxError, AttributeError, IndexError, MemoryError),
        *(OSError, zipfile.BadZipFile, zlib.error, msgspec.DecodeError),
    ) as error:
        # What zipfile and NumPy say to damaged bytes is not one family of errors.
        raise _damaged(path, " ".join(str(error).split())[:120]) from None
    return about, scan_ns


def _missing(path: Path) -> InputError:
    number = path.name.partition(".")[0]
    return InputError(
        f"{path}: is missing; bring it back from a copy, or move what is left of {number}.* away: "
        "then that time is read as a gap"
    )


def _damaged(path: Path, why: str) -> InputError:
    number = path.name.partition(".")[0]
    return InputError(
        f"{path}: is damaged ({why}); bring it back from a copy, or move {number}.* away: "
        "then that time is read as a gap"
    )


def _crc32(path: Path) -> int:
    check_sum = 0
    with path.open("rb") as stream:
        while chunk := stream.read(_CHUNK_BYTES):
            check_sum = zlib.crc32(chunk, check_sum)
    return check_sum
