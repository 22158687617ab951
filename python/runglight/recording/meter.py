"""How a recording is going: rates and scan jitter over the last seconds."""

from __future__ import annotations

from collections import deque

import numpy as np

from runglight.recording.block import Integers
from runglight.recording.stretch import batch_start_ns
from runglight.taps.base import Batch

WINDOW_S = 10.0


class Meter:
    """Takes batches; tells rates over the last ten seconds of the tap's time."""

    def __init__(self, interval_ns: int | None) -> None:
        self._interval_ns = interval_ns
        self._seen: deque[tuple[int, int, Integers]] = deque()
        self._start_ns: int | None = None
        self._until_ns = 0

    def take(self, batch: Batch) -> None:
        """Counts a batch; an image is no change."""
        if self._start_ns is None:
            self._start_ns = batch_start_ns(batch)
        self._until_ns = batch.until_ns
        changes = 0 if batch.image else len(batch)
        self._seen.append((batch.until_ns, changes, batch.scan_ns))
        while self._seen[0][0] < self._until_ns - WINDOW_S * 1e9:
            self._seen.popleft()

    @property
    def recorded_s(self) -> float:
        """Seconds of the tap's time since the first batch."""
        return 0.0 if self._start_ns is None else (self._until_ns - self._start_ns) / 1e9

    @property
    def changes_per_s(self) -> float:
        """Changes per second."""
        return self._rate(sum(changes for _, changes, _ in self._seen))

    @property
    def scans_per_s(self) -> float:
        """Scans per second; 0 where the source sends by itself."""
        return self._rate(sum(len(scans) for *_, scans in self._seen))

    @property
    def jitter_p99_ms(self) -> float | None:
        """How far 99 of 100 scans at most lay from their interval; None before there were any.

        Where scans come as fast as they can, the interval is the median.
        """
        scans = [scans for *_, scans in self._seen if len(scans)]
        steps = np.diff(np.concatenate(scans)) if scans else np.empty(0, np.int64)
        if not len(steps):
            return None
        interval_ns = self._interval_ns or int(np.median(steps))
        return float(np.percentile(np.abs(steps - interval_ns), 99)) / 1e6

    def _rate(self, count: int) -> float:
        seconds = min(self.recorded_s, WINDOW_S)
        return count / seconds if seconds > 0 else 0.0
