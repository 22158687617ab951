"""Reading a recording: whole or a range of time, also while a recorder is at work."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from datetime import datetime
from functools import partial
from os import PathLike
from pathlib import Path

import numpy as np

from runglight.errors import InputError
from runglight.log.changelog import Log
from runglight.log.report import ReadReport
from runglight.moments import nanoseconds
from runglight.recording.block import Integers
from runglight.recording.description import Description, read_description
from runglight.recording.layout import TAIL, changes_file, scans_file, sealed_numbers
from runglight.recording.segment import read_head, read_segment
from runglight.recording.stretch import Stretch, TimeRange, gaps_of
from runglight.recording.tail import read_tail
from runglight.taps.base import Gap, Mark

MISSING = "a segment of the recording is missing"


@dataclass(frozen=True, slots=True)
class Recording:
    """What was recorded: the log, and what a log has no room for."""

    description: Description
    log: Log
    scan_ns: Integers
    """Time of every scan."""
    marks: tuple[Mark, ...]
    """Gaps with their reasons, and steps of the clock."""
    until_ns: int
    """Up to here everything is there; 0 where nothing was recorded."""


def read_recording(
    directory: str | PathLike[str],
    since: datetime | int | None = None,
    until: datetime | int | None = None,
) -> Log:
    """The log of a recording, with its gaps and scan interval.

    `since` and `until` (aware datetimes, or nanoseconds since 1970) name a range, both ends
    included; what lies outside is not even opened. InputError where a file is damaged.
    """
    return open_recording(directory, since, until, scans=False).log


def open_recording(
    directory: str | PathLike[str],
    since: datetime | int | None = None,
    until: datetime | int | None = None,
    *,
    scans: bool = True,
) -> Recording:
    """The log of a recording, its scans and its marks; arguments as in `read_recording`.

    Without `scans` their times are not read (`scan_ns` is then not to be counted on).
    """
    path = Path(directory)
    within = TimeRange(
        None if since is None else nanoseconds(since), None if until is None else nanoseconds(until)
    )
    notes: list[str] = []
    try:
        # The tail first: what it says is sealed is sealed, and what it counts on is described.
        tail, numbers = _tail_and_segments(path, notes)
        description = read_description(path)
        by_name = {signal.name: at for at, signal in enumerate(description.signals)}
        read = partial(read_segment, path, numbers=by_name, scans=scans)
        pieces = [*_segments(path, numbers, read, within, notes), *tail]
    except OSError as error:
        place = error.filename or path
        raise InputError(f"{place}: cannot be read ({error.strerror}); check the disk") from None
    stretches, holes = _in_range(pieces, within)
    return _recording(path, description, stretches, holes, notes)


def log_to_its_end(directory: str | PathLike[str]) -> Log:
    """The log of a recording, closed by a sample where recording ended after the last change.

    A line that stands still until the end is told from one that was not watched any more.
    """
    recording = open_recording(directory, scans=False)
    log = recording.log
    time_ns, signal_index, value = log.columns()
    if not len(log) or recording.until_ns <= time_ns[-1]:
        return log
    last = signal_index[-1]
    closed = Log.from_columns(
        np.append(time_ns, recording.until_ns),
        np.append(signal_index, last),
        np.append(value, value[-1]),
        log.signals,
        log.scan_interval_s,
        gaps=log.engine.gaps,
    )
    return Log(closed.engine, log.path, log.report)


def _tail_and_segments(path: Path, notes: list[str]) -> tuple[list[Stretch], list[int]]:
    if not (path / TAIL).exists():
        numbers = sealed_numbers(path)
        notes.append(f"{TAIL} is missing: what was not yet in a segment is not there")
        return [], _up_to(numbers[-1] if numbers else 0)
    state, blocks = read_tail(path)
    if not state.until_ns:
        return [], []
    # Time may have gone on since the last block.
    tail = Stretch.of([block for _, block in blocks]) if blocks else Stretch.quiet(state.until_ns)
    return [replace(tail, until_ns=state.until_ns)], _up_to(state.segments)


def _up_to(number: int) -> list[int]:
    return list(range(1, number + 1))


def _segments(
    path: Path,
    numbers: list[int],
    read: Callable[[int], Stretch],
    within: TimeRange,
    notes: list[str],
) -> Iterator[Stretch | None]:
    """The segments in range; None for one that is missing."""
    for number in numbers:
        if not scans_file(path, number).exists() and not changes_file(path, number).exists():
            notes.append(f"segment {number:06d} is missing: that time is a gap")
            yield None
            continue
        head = read_head(path, number)
        if within.touches(head):
            yield read(number)


def _in_range(
    pieces: Iterable[Stretch | None], within: TimeRange
) -> tuple[list[Stretch], list[Mark]]:
    """What lies in the range, and a gap for each hole between two pieces."""
    stretches: list[Stretch] = []
    holes: list[Mark] = []
    hole = False
    for piece in pieces:
        if piece is None:
            hole = True
        elif within.touches(piece):
            stretch = piece.within(within)
            if hole and stretches:
                before_ns = stretches[-1].until_ns
                holes.append(Gap(before_ns, max(before_ns, stretch.start_ns), MISSING))
            stretches.append(stretch)
            hole = False
    return stretches, holes


def _recording(
    path: Path,
    description: Description,
    stretches: list[Stretch],
    holes: list[Mark],
    notes: list[str],
) -> Recording:
    none: Integers = np.empty(0, np.int64)
    time_ns = np.concatenate([none, *(each.time_ns for each in stretches)])
    signal = np.concatenate([none, *(each.signal for each in stretches)])
    value = np.concatenate([none, *(each.value for each in stretches)])
    scan_ns = np.concatenate([none, *(each.scan_ns for each in stretches)])
    marks = [*holes, *(mark for each in stretches for mark in each.marks)]
    interval_ns = _scan_interval_ns(description.interval_ns, stretches)
    if len(signal) and int(signal.max()) >= len(description.signals):
        raise InputError(
            f"{path}: recording.json lacks signals that were recorded; bring it back from a copy"
        )
    log = Log.from_columns(
        time_ns,
        signal.astype(np.uint32),
        value,
        [each.name for each in description.signals],
        scan_interval_s=None if interval_ns is None else interval_ns / 1e9,
        gaps=gaps_of(marks),
    )
    report = ReadReport(format="recording", rows=len(log), notes=notes)
    return Recording(
        description=description,
        log=Log(log.engine, os.fspath(path), report),
        scan_ns=scan_ns,
        marks=tuple(marks),
        until_ns=stretches[-1].until_ns if stretches else 0,
    )


def _scan_interval_ns(wanted_ns: int | None, stretches: list[Stretch]) -> int | None:
    """What the scans really took where that is longer than wanted; None where there are none."""
    taken_ns = [each.scan_interval_ns for each in stretches if each.scan_interval_ns is not None]
    if wanted_ns is None or not taken_ns:
        return wanted_ns or None
    return max(wanted_ns, int(np.median(taken_ns)))
