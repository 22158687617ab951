"""What the page needs of a live tap: the last minutes to draw, the values now, a recording."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from runglight import _engine
from runglight.errors import InputError
from runglight.recording.meter import Meter
from runglight.recording.recorder import Recorder
from runglight.taps.base import Batch, Gap

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from runglight.taps.base import Tap

KEPT_NS = 3600 * 1_000_000_000
KEPT_ROWS = 4_000_000
"""The last hour can be looked at live, or as much of it as fits into about 64 MB."""
FORGET_EVERY_NS = 30 * 1_000_000_000


class LiveFeed:
    """Takes every batch of a tap after it was watched (the seam `live.session.Recording`)."""

    def __init__(self, tap: Tap, say: Callable[[str], None]) -> None:
        self.tap = tap
        self.diagram = _engine.TimingDiagram()
        self.start_ns: int | None = None
        self.until_ns = 0
        self.gaps: list[tuple[int, int]] = []
        self.recorder: Recorder | None = None
        self.recording_since_ns = 0
        self.meter: Meter | None = None
        self.listeners: list[Callable[[Batch], None]] = []
        """Are given every batch, after it was taken."""
        self._say = say
        self._forgotten_ns = 0
        self._rows = 0
        self._last: dict[int, tuple[int, int]] = {}

    def append(self, batch: Batch) -> None:
        """Takes a batch; never raises."""
        if self.start_ns is None:
            self.start_ns = int(batch.time_ns[0]) if len(batch) else batch.until_ns
        self.until_ns = batch.until_ns
        self.gaps += [(mark.start_ns, mark.end_ns) for mark in batch.marks if isinstance(mark, Gap)]
        if len(batch):
            self.diagram.append(batch.time_ns, batch.signal_index, batch.value)
            self._rows += len(batch)
            for index, time_ns, value in zip(
                batch.signal_index.tolist(),
                batch.time_ns.tolist(),
                batch.value.tolist(),
                strict=True,
            ):
                before = self._last.get(index)
                if before is None or before[1] != value:
                    self._last[index] = (time_ns, value)
        self._forget()
        if self.recorder is not None:
            self._record(batch)
        for listener in self.listeners:
            listener(batch)

    def forget_listener(self, listener: Callable[[Batch], None]) -> None:
        """Gives it no more batches."""
        if listener in self.listeners:
            self.listeners.remove(listener)

    def close(self) -> None:
        """Ends the recording, where one is made. May take a while."""
        if self.recorder is not None:
            recorder, self.recorder = self.recorder, None
            recorder.close()

    def value(self, index: int) -> tuple[int, int] | None:
        """When a signal took the value it has now, and which; None before its first row."""
        return self._last.get(index)

    def record(self, directory: Path, reserve_bytes: int) -> None:
        """Records from the next batch on; InputError where it cannot be."""
        if self.recorder is not None:
            raise InputError(f"{self.recorder.directory.name}: is being recorded; stop that first")
        if not self._last:
            raise InputError("nothing has come from the machine yet; check the connection")
        recorder = Recorder(directory, self.tap, reserve_bytes=reserve_bytes)
        # A recording begins with all signals as they stand.
        recorder.append(self._image())
        self.meter = Meter(self.tap.interval_ns)
        self.recording_since_ns = self.until_ns
        self.recorder = recorder

    def _image(self) -> Batch:
        indices = sorted(self._last)
        return Batch(
            until_ns=self.until_ns,
            time_ns=np.full(len(indices), self.until_ns, np.int64),
            signal_index=np.array(indices, np.uint32),
            value=np.array([self._last[index][1] for index in indices], np.int64),
            image=True,
        )

    def _record(self, batch: Batch) -> None:
        assert self.recorder is not None
        assert self.meter is not None
        if batch.until_ns < self.recording_since_ns:
            return
        try:
            self.recorder.append(replace(batch))
            self.meter.take(batch)
        except InputError as error:
            self.recorder = None
            self._say(f"{error}; watching goes on")

    def _forget(self) -> None:
        if self.until_ns - self._forgotten_ns < FORGET_EVERY_NS:
            return
        self._forgotten_ns = self.until_ns
        oldest_ns = self.until_ns - KEPT_NS
        if self._rows > KEPT_ROWS and self.start_ns is not None:
            # Rows come evenly enough to tell by time which are too many.
            span_ns = self.until_ns - self.start_ns
            oldest_ns = max(oldest_ns, self.until_ns - span_ns * KEPT_ROWS // self._rows)
        if self.start_ns is not None and oldest_ns > self.start_ns:
            self.diagram.forget_before(oldest_ns)
            self.start_ns = oldest_ns
            self._rows = sum(map(self.diagram.changes, range(self.diagram.lanes)))
            self.gaps = [gap for gap in self.gaps if gap[1] >= oldest_ns]
