"""Batches of a tap through the monitor: gaps, images, changes, and the time that goes on."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from runglight.taps.base import Batch, Gap

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from runglight.model import Monitor, NominalModel
    from runglight.taps.base import TapSignal


class BatchWatcher:
    """Gives the findings of each batch, the same ones as the same rows read from a log.

    `monitor` is one of `model`, new or restored; `signals` is the tap's list, which grows while it
    runs; `name_of` says what the model calls a signal. With `goes_on`, what comes is what comes
    next after the restored state (logs replayed one after the other); otherwise there is a gap.
    """

    def __init__(
        self,
        model: NominalModel,
        monitor: Monitor,
        signals: Sequence[TapSignal],
        name_of: Callable[[TapSignal], str],
        *,
        goes_on: bool = False,
    ) -> None:
        self._model = model
        self._monitor = monitor
        self._signals = signals
        self._name_of = name_of
        self._bound = 0
        # A restored monitor has not seen what happened since its state was kept.
        self._interrupted_ns = monitor.now_ns
        self._goes_on = goes_on
        self.late_rows = 0
        """Rows a tap gave after having said that time had passed them; taken as if just now."""

    def take(self, batch: Batch) -> list[str]:
        """The findings of one batch, as JSON lines."""
        lines = self._after_interruption(batch)
        if len(self._signals) != self._bound:
            self._monitor.bind([self._name_of(signal) for signal in self._signals])
            self._bound = len(self._signals)
        for mark in batch.marks:
            if isinstance(mark, Gap):
                start_ns = max(mark.start_ns, self._monitor.now_ns or mark.start_ns)
                end_ns = max(mark.end_ns, start_ns)
                lines += self._monitor.gap(start_ns, end_ns).json_lines()
        if len(batch):
            observe = self._monitor.observe_image if batch.image else self._monitor.observe_rows
            time_ns = self._in_order(batch)
            lines += observe(time_ns, batch.signal_index, batch.value).json_lines()
        # `until_ns` itself has passed: what comes next is later by a nanosecond at least.
        lines += self._monitor.advance(batch.until_ns + 1).json_lines()
        return lines

    def complete(self) -> list[str]:
        """No batch will come for a while, or ever: judges the scan that waits for its end."""
        return self._monitor.finish().json_lines()

    def take_snapshots(self) -> list[str]:
        """Snapshots made since the last call, as JSON."""
        return self._monitor.take_snapshots()

    def state(self) -> bytes:
        """What a restart goes on from."""
        return self._monitor.state()

    def _after_interruption(self, batch: Batch) -> list[str]:
        if self._interrupted_ns is None:
            return []
        start_ns, self._interrupted_ns = self._interrupted_ns, None
        end_ns = int(batch.time_ns[0]) if len(batch) else batch.until_ns
        if end_ns < start_ns:
            # A log replayed again, or a clock set back while nobody watched.
            self._monitor = self._model.monitor()
            self._bound = 0
            return []
        if self._goes_on:
            return []
        return self._monitor.gap(start_ns, end_ns).json_lines()

    def _in_order(self, batch: Batch) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
        now_ns = self._monitor.now_ns
        if now_ns is None or batch.time_ns[0] >= now_ns:
            return batch.time_ns
        # A tap that breaks its word must not end the watch at three in the morning.
        self.late_rows += int(np.count_nonzero(batch.time_ns < now_ns))
        return np.maximum(batch.time_ns, now_ns)
