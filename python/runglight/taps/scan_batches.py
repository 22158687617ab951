"""From whole images to batches of changes."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from runglight.taps.base import QUIET_NS, Batch, ClockStep, Gap, Mark

SCANS_AFTER_A_CHANGE = 2
"""Scans that leave at once after one that saw a change: whoever watches judges a scan when its end
is known, and one scan may come a little early."""


class ScanBatches:
    """Compares each scan with the one before; scans that saw nothing share a batch.

    A change makes a batch at once, and so does whatever has to be told. Time never runs backwards.
    """

    def __init__(
        self, values: Callable[[bytes], npt.NDArray[np.int64]], interval_ns: int = 0
    ) -> None:
        self._decode = values
        # A batch has to leave with the last scan before it would be late.
        self._quiet_ns = max(QUIET_NS - interval_ns, 0)
        self._image: bytes | None = None
        self._values: npt.NDArray[np.int64] = np.empty(0, np.int64)
        self._idle_ns: list[int] = []
        self._told_ns = 0
        self._at_once = 0
        self._gap: str | None = None
        self.last_ns: int | None = None
        """Time of the last good scan."""

    def is_change(self, image: bytes) -> bool:
        """Whether a scan shows something else than the one before."""
        return self._image is not None and image != self._image

    def lost(self, reason: str) -> list[Batch]:
        """Nothing is seen from the last scan on; the next one gives a gap and a whole image."""
        self._image = None
        if self._gap is None:
            self._gap = reason
        return self._flush()

    def take(self, image: bytes, time_ns: int, step_ns: int | None = None) -> list[Batch]:
        """One good scan; `step_ns` where the computer's clock was set since the last one."""
        last_ns = self.last_ns
        time_ns = time_ns if last_ns is None else max(time_ns, last_ns)
        self.last_ns = time_ns
        if image == self._image and step_ns is None:
            self._idle_ns.append(time_ns)
            self._at_once -= 1
            due = self._at_once >= 0 or time_ns - self._told_ns >= self._quiet_ns
            return self._flush() if due else []
        marks: list[Mark] = []
        if self._gap is not None and last_ns is not None:
            marks.append(Gap(last_ns, time_ns, self._gap))
        if step_ns is not None:
            marks.append(ClockStep(time_ns, step_ns))
        self._gap = None
        # What a mark tells lies between the idle scans and this one.
        earlier = self._flush() if marks else []
        return [*earlier, self._changed(image, time_ns, tuple(marks))]

    def _changed(self, image: bytes, time_ns: int, marks: tuple[Mark, ...]) -> Batch:
        whole = self._image is None
        values = self._values if image == self._image else self._decode(image)
        rows = np.arange(len(values)) if whole else np.flatnonzero(values != self._values)
        self._image, self._values = image, values
        scans = [*self._idle_ns, time_ns]
        self._idle_ns = []
        self._told_ns = time_ns
        self._at_once = 0 if whole or not len(rows) else SCANS_AFTER_A_CHANGE
        return Batch(
            until_ns=time_ns,
            time_ns=np.full(len(rows), time_ns, np.int64),
            signal_index=rows.astype(np.uint32),
            value=values[rows],
            scan_ns=np.array(scans, np.int64),
            marks=marks,
            image=whole,
        )

    def _flush(self) -> list[Batch]:
        if not self._idle_ns:
            return []
        batch = Batch(until_ns=self._idle_ns[-1], scan_ns=np.array(self._idle_ns, np.int64))
        self._told_ns = batch.until_ns
        self._idle_ns = []
        return [batch]
