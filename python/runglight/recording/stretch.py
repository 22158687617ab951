"""A stretch of recorded time: what one segment, or the tail, holds."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from runglight.recording.block import Block, Integers
from runglight.taps.base import ClockStep, Gap, Mark


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

    @classmethod
    def of(cls, blocks: Sequence[Block]) -> Stretch:
        """Joins blocks, of which there is at least one."""
        marks = tuple(mark for block in blocks for mark in block.marks)
        time_ns = np.concatenate([block.time_ns for block in blocks])
        scan_ns = np.concatenate([block.scan_ns for block in blocks])
        begins = [blocks[0].until_ns, *time_ns[:1].tolist(), *scan_ns[:1].tolist()]
        return cls(
            start_ns=min(begins + [_begin(mark) for mark in marks]),
            until_ns=blocks[-1].until_ns,
            time_ns=time_ns,
            signal=np.concatenate([block.signal for block in blocks]),
            value=np.concatenate([block.value for block in blocks]),
            scan_ns=scan_ns,
            marks=marks,
        )

    def within(self, since_ns: int | None, until_ns: int | None) -> Stretch:
        """What lies in [since, until]; gaps are cut to it."""
        if (since_ns is None or since_ns <= self.start_ns) and (
            until_ns is None or until_ns >= self.until_ns
        ):
            return self
        since = self.start_ns if since_ns is None else since_ns
        until = self.until_ns if until_ns is None else until_ns
        rows = _between(self.time_ns, since, until)
        return replace(
            self,
            start_ns=max(self.start_ns, since),
            until_ns=min(self.until_ns, until),
            time_ns=self.time_ns[rows],
            signal=self.signal[rows],
            value=self.value[rows],
            scan_ns=self.scan_ns[_between(self.scan_ns, since, until)],
            marks=tuple(_cut(self.marks, since, until)),
        )


def gaps_of(marks: Iterable[Mark]) -> list[tuple[int, int]]:
    """Start and end of every gap, as logs have them."""
    return [(mark.start_ns, mark.end_ns) for mark in marks if isinstance(mark, Gap)]


def _begin(mark: Mark) -> int:
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
