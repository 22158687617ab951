"""A stretch of recorded time: what one segment, or the tail, holds."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from runglight.recording.block import Block, Integers
from runglight.taps.base import Batch, ClockStep, Gap, Mark


@dataclass(frozen=True, slots=True)
class Stretch:
    """Columns between two times; signals by their number in the recording."""

    start_ns: int
    until_ns: int
    time_ns: Integers
    signal: Integers
    value: Integers
    scan_ns: Integers
    marks: tuple[Mark, ...] = ()
    scan_interval_ns: int | None = None
    """Median time between two scans; None for fewer than two."""

    @classmethod
    def of(cls, blocks: Sequence[Block]) -> Stretch:
        """Joins blocks, of which there is at least one."""
        marks = tuple(mark for block in blocks for mark in block.marks)
        time_ns = np.concatenate([block.time_ns for block in blocks])
        scan_ns = np.concatenate([block.scan_ns for block in blocks])
        firsts = (int(times[0]) for times in (time_ns, scan_ns) if len(times))
        return cls(
            start_ns=min([blocks[0].until_ns, *firsts, *map(begin_ns, marks)]),
            until_ns=blocks[-1].until_ns,
            time_ns=time_ns,
            signal=np.concatenate([block.signal for block in blocks]),
            value=np.concatenate([block.value for block in blocks]),
            scan_ns=scan_ns,
            marks=marks,
            scan_interval_ns=int(np.median(np.diff(scan_ns))) if len(scan_ns) > 1 else None,
        )

    @classmethod
    def quiet(cls, time_ns: int) -> Stretch:
        """A moment at which nothing happened."""
        none: Integers = np.empty(0, np.int64)
        return cls(time_ns, time_ns, none, none, none, none)

    def within(self, range: TimeRange) -> Stretch:
        """What lies in a range; gaps are cut to it."""
        since_ns, until_ns = range.over(self)
        if (since_ns, until_ns) == (self.start_ns, self.until_ns):
            return self
        rows = _between(self.time_ns, since_ns, until_ns)
        return replace(
            self,
            start_ns=since_ns,
            until_ns=until_ns,
            time_ns=self.time_ns[rows],
            signal=self.signal[rows],
            value=self.value[rows],
            scan_ns=self.scan_ns[_between(self.scan_ns, since_ns, until_ns)],
            marks=tuple(_cut(self.marks, since_ns, until_ns)),
        )


class Timed(Protocol):
    """What has a beginning and an end."""

    @property
    def start_ns(self) -> int: ...  # noqa: D102
    @property
    def until_ns(self) -> int: ...  # noqa: D102


@dataclass(frozen=True, slots=True)
class TimeRange:
    """Both ends included; None where it is open."""

    since_ns: int | None = None
    until_ns: int | None = None

    def touches(self, timed: Timed) -> bool:
        """Whether some of it lies in the range."""
        since_ns, until_ns = self.over(timed)
        return since_ns <= until_ns

    def over(self, timed: Timed) -> tuple[int, int]:
        """What both have in common; turned round where that is nothing."""
        return (
            timed.start_ns if self.since_ns is None else max(timed.start_ns, self.since_ns),
            timed.until_ns if self.until_ns is None else min(timed.until_ns, self.until_ns),
        )


def batch_start_ns(batch: Batch) -> int:
    """When the first of what a batch tells happened."""
    firsts = (int(times[0]) for times in (batch.time_ns, batch.scan_ns) if len(times))
    return min([batch.until_ns, *firsts, *map(begin_ns, batch.marks)])


def gaps_of(marks: Iterable[Mark]) -> list[tuple[int, int]]:
    """Start and end of every gap, as logs have them."""
    return [(mark.start_ns, mark.end_ns) for mark in marks if isinstance(mark, Gap)]


def begin_ns(mark: Mark) -> int:
    """When what a mark tells began."""
    return mark.start_ns if isinstance(mark, Gap) else mark.time_ns


def _between(times: Integers, since: int, until: int) -> slice:
    return slice(
        int(np.searchsorted(times, since, "left")), int(np.searchsorted(times, until, "right"))
    )


def _cut(marks: Iterable[Mark], since: int, until: int) -> Iterable[Mark]:
    for mark in marks:
        if isinstance(mark, ClockStep):
            if since <= mark.time_ns <= until:
                yield mark
        elif mark.end_ns >= since and mark.start_ns <= until:
            yield replace(mark, start_ns=max(mark.start_ns, since), end_ns=min(mark.end_ns, until))
