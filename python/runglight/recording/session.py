"""One run of a recorder: its times go on where the run before ended, and never backwards."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from runglight.recording.stretch import batch_start_ns
from runglight.recording.tail import TailState
from runglight.taps.base import Batch, ClockStep, Gap, Mark

STOPPED = "recording stopped"
CUT_OFF = "the recorder was cut off"


class Session:
    """Takes a tap's batches in order, and marks the time between the run before and this one."""

    def __init__(self, before: TailState) -> None:
        self._before = before
        self._begun = False
        self._shift_ns = 0
        self._latest_ns = before.until_ns

    def taken(self, batch: Batch) -> Batch:
        """The batch as it is recorded; ValueError where its times run backwards."""
        marks: tuple[Mark, ...] = ()
        if not self._begun:
            self._begun = True
            marks = self._joint(batch_start_ns(batch))
        if self._shift_ns:
            batch = _shifted(batch, self._shift_ns)
        self._check(batch)
        self._latest_ns = batch.until_ns
        return replace(batch, marks=(*marks, *batch.marks)) if marks else batch

    def _joint(self, start_ns: int) -> tuple[Mark, ...]:
        """The gap to the run before. A clock set back in between is told as a step of the clock."""
        before = self._before
        if before.until_ns == 0:
            return ()
        reason = STOPPED if before.closed else CUT_OFF
        if start_ns > before.until_ns:
            return (Gap(before.until_ns, start_ns, reason),)
        self._shift_ns = before.until_ns + 1 - start_ns
        now_ns = before.until_ns + 1
        return (Gap(before.until_ns, now_ns, reason), ClockStep(now_ns, -self._shift_ns))

    def _check(self, batch: Batch) -> None:
        if batch.until_ns < self._latest_ns:
            raise ValueError(f"a tap went back in time: {batch.until_ns} after {self._latest_ns}")
        for times in (batch.time_ns, batch.scan_ns):
            if not len(times):
                continue
            if times[0] < self._latest_ns or times[-1] > batch.until_ns:
                raise ValueError("a tap's batch holds times outside it")
            if len(times) > 1 and np.any(times[1:] < times[:-1]):
                raise ValueError("a tap's times run backwards")


def _shifted(batch: Batch, shift_ns: int) -> Batch:
    return replace(
        batch,
        until_ns=batch.until_ns + shift_ns,
        time_ns=batch.time_ns + shift_ns,
        scan_ns=batch.scan_ns + shift_ns,
        marks=tuple(
            replace(mark, start_ns=mark.start_ns + shift_ns, end_ns=mark.end_ns + shift_ns)
            if isinstance(mark, Gap)
            else replace(mark, time_ns=mark.time_ns + shift_ns)
            for mark in batch.marks
        ),
    )
