"""What arrived from a source that sends by itself, put into batches in time order.

Values wait for `reorder_ns`, so that one which was stamped earlier and arrives later still finds
its place. A value later than that is stamped at the edge up to which all has been handed on, and
counted. Values without a stamp need not wait, unless others of the source carry one.
"""

from collections.abc import Iterable, Mapping
from heapq import heappop, heappush

import numpy as np

from runglight.taps.base import QUIET_NS, Batch, ClockStep, Gap, Mark
from runglight.taps.clock import Clock
from runglight.taps.source_time import SourceTime

HEARTBEAT_NS = QUIET_NS // 2
"""Half the longest silence that is allowed: a late event loop must not break the promise."""


class Arrivals:
    """Turns values, images and losses into batches; knows nothing of sockets."""

    def __init__(self, clock: Clock, reorder_ns: int, *, stamped: bool = True) -> None:
        self._clock = clock
        self._reorder_ns = reorder_ns
        # Where stamps may come or not (`stamped=False`), the window opens with the first one.
        self._stamped = stamped
        self._source_times: dict[str, SourceTime] = {}
        # Values of the same time keep the order in which they arrived.
        self._waiting: list[tuple[int, int, int, int]] = []
        self._count = 0
        self._marks: list[Mark] = []
        self._ready: list[Batch] = []
        self._edge_ns = 0
        self._row_ns = 0
        self._handed_ns = 0
        self._heard_ns: int | None = None
        self._gap: tuple[int, str] | None = None
        self._connected = False
        self._values: dict[int, int] = {}
        self.late = 0
        """Values that came after their time had been handed on."""

    def widen(self, reorder_ns: int) -> None:
        """Values are known to lie about for that long before they are sent."""
        self._reorder_ns = max(self._reorder_ns, reorder_ns)

    @property
    def implausible(self) -> int:
        """Time stamps that were no time of this moment."""
        return sum(times.implausible for times in self._source_times.values())

    @property
    def waiting(self) -> int:
        """Values that nobody has taken yet."""
        return len(self._waiting)

    @property
    def unread(self) -> bool:
        """Whether batches lie ready that nobody has taken."""
        return bool(self._ready)

    @property
    def values(self) -> Mapping[int, int]:
        """The last value of each signal that is known to stand."""
        return self._values

    def heard(self) -> None:
        """The source gave a sign of life."""
        self._heard_ns = self._clock.now_ns()

    def value(
        self, signal_index: int, value: int, stamp_ns: int | None = None, source: str = ""
    ) -> None:
        """One value; `stamp_ns` is when it came about by the clock of `source`."""
        now_ns = self._clock.now_ns()
        self._heard_ns = now_ns
        time_ns = now_ns
        if stamp_ns is not None:
            self._stamped = True
            times = self._source_times.get(source)
            if times is None:
                times = self._source_times[source] = SourceTime(self._reorder_ns)
            time_ns = times.ours(stamp_ns, now_ns)
        if time_ns <= self._edge_ns:
            # A value without a stamp in the very nanosecond of the edge is not late.
            self.late += stamp_ns is not None
            time_ns = self._edge_ns + 1
        self._values[signal_index] = value
        self._count += 1
        heappush(self._waiting, (time_ns, self._count, signal_index, value))

    def image(self, values: Mapping[int, int]) -> None:
        """The source is connected, and its signals stand at `values`."""
        now_ns = self._now_after_all()
        self._values = dict(values)
        self._connected = True
        if self._gap is not None:
            start_ns, reason = self._gap
            self._marks.append(Gap(min(start_ns, now_ns), now_ns, reason))
            self._gap = None
        self._heard_ns = now_ns
        self._append_image(now_ns)

    def resume(self, values: Mapping[int, int], since_ns: int, reason: str) -> None:
        """Signals that were not seen since `since_ns` stand at `values`; the others went on.

        A gap concerns the whole tap, so it begins only after the last row that was handed on.
        """
        now_ns = self._now_after_all()
        self._values |= values
        self._marks.append(Gap(min(max(since_ns, self._row_ns), now_ns), now_ns, reason))
        self._append_image(now_ns)

    def forget(self, signal_indices: Iterable[int]) -> None:
        """These signals are not known to stand any more; the next image is without them."""
        for index in signal_indices:
            self._values.pop(index, None)

    def lost(self, reason: str) -> None:
        """The connection is gone: a gap begins at the last word heard."""
        if self._connected:
            self._now_after_all()
        self._connected = False
        self._values.clear()
        self._source_times.clear()
        if self._gap is None and self._heard_ns is not None:
            self._gap = (max(self._heard_ns, self._row_ns), reason)

    def take(self) -> list[Batch]:
        """The batches that are due."""
        now_ns = self._clock.now_ns()
        step_ns = self._clock.take_step_ns()
        if step_ns is not None:
            # The values before the step go first; a step is rare, their order is not at risk.
            self._release(now_ns)
            self._marks.append(ClockStep(now_ns, step_ns))
        if self._connected and not self._ready:
            # Right after an image the window lies before the edge; time goes on all the same.
            until_ns = max(now_ns - (self._reorder_ns if self._stamped else 0), self._edge_ns + 1)
            due = bool(self._waiting) and self._waiting[0][0] <= until_ns
            if due or self._marks or now_ns - self._handed_ns >= HEARTBEAT_NS:
                self._release(until_ns, heartbeat=True)
        ready, self._ready = self._ready, []
        if ready:
            self._handed_ns = now_ns
        return ready

    def next_due_ns(self) -> int:
        """When `take` has something again, if nothing arrives; at most a heartbeat away."""
        due_ns = max(self._handed_ns, self._clock.now_ns() - HEARTBEAT_NS) + HEARTBEAT_NS
        if self._waiting and self._connected:
            wait_ns = self._reorder_ns if self._stamped else 0
            due_ns = min(due_ns, self._waiting[0][0] + wait_ns)
        return due_ns

    def _now_after_all(self) -> int:
        """Hands on all that waits; the time after it."""
        now_ns = self._clock.now_ns()
        self._release(max(now_ns, self._edge_ns + 1))
        return max(now_ns, self._edge_ns + 1)

    def _append_image(self, now_ns: int) -> None:
        indices = sorted(self._values)
        self._append(
            now_ns, [(now_ns, 0, index, self._values[index]) for index in indices], image=True
        )

    def _release(self, until_ns: int, *, heartbeat: bool = False) -> None:
        rows = []
        while self._waiting and self._waiting[0][0] <= until_ns:
            rows.append(heappop(self._waiting))
        if rows or heartbeat:
            self._append(max(until_ns, self._edge_ns), rows)

    def _append(
        self, until_ns: int, rows: list[tuple[int, int, int, int]], *, image: bool = False
    ) -> None:
        marks, self._marks = tuple(self._marks), []
        time_ns, _, indices, values = zip(*rows, strict=True) if rows else ((), (), (), ())
        self._edge_ns = max(until_ns, self._edge_ns)
        if rows:
            self._row_ns = rows[-1][0]
        self._ready.append(
            Batch(
                until_ns=until_ns,
                time_ns=np.array(time_ns, np.int64),
                signal_index=np.array(indices, np.uint32),
                value=np.array(values, np.int64),
                marks=marks,
                image=image,
            )
        )
