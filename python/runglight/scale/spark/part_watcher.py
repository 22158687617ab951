"""One part of a plant from one micro-batch to the next: waits for order, judges, sets its alarm.

Nothing here knows Spark. What it returns depends on what it is given alone, so that a batch that
is run again after a crash gives the same findings.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeGuard

import numpy as np

from runglight.errors import RunglightError
from runglight.scale.spark import chunk, notices
from runglight.scale.spark.opening import Opening, earliest
from runglight.scale.wire import GAP

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    import pyarrow as pa

    from runglight.findings.batch import Findings
    from runglight.model import Monitor
    from runglight.scale.spark.plant_parts import PlantParts

MS = 1_000_000


@dataclass(frozen=True)
class PartState:
    """What is known of a part between two batches."""

    model: str
    """Fingerprint of the model that the monitor is of."""
    monitor: bytes | None
    """None until the watermark has passed the plant's first change."""
    waiting: bytes | None
    """Changes whose turn has not come: the watermark has not passed them."""
    wake_ms: int
    """Event time at which this part has something to do without a new change."""
    opening: Opening | None = None
    """When the rows of the plant begin; None when the part has judged some."""


@dataclass
class Told:
    """Findings as JSON lines, and the snapshots they name."""

    lines: list[str] = field(default_factory=list)
    snapshots: list[str] = field(default_factory=list)

    def take(self, findings: Findings, monitor: Monitor) -> None:
        """Adds what a monitor found."""
        self.lines += findings.json_lines()
        self.snapshots += monitor.take_snapshots()


class PartWatcher:
    """Judges the changes of one part as far as the watermark reaches."""

    def __init__(
        self, plant: str, part: str, fingerprint: str, parts: PlantParts, quiet_ns: int
    ) -> None:
        self._plant = plant
        self._part = part
        self._fingerprint = fingerprint
        self._parts = parts
        self._quiet_ns = quiet_ns

    def step(
        self,
        state: PartState | None,
        chunks: Sequence[bytes],
        watermark_ns: int,
        openings: Iterable[Opening] = (),
    ) -> tuple[Told, PartState]:
        """Takes new changes, judges all that are older than the watermark.

        Every change older than the watermark has come, as far as the watermark keeps its promise.
        One that is older than what its own part was judged up to cannot be judged any more.
        """
        if self._nothing_to_do(state, chunks, watermark_ns):
            return Told(), state
        told = Told()
        waiting = [] if state is None or state.waiting is None else [state.waiting]
        table = chunk.in_order(chunk.unpack([*waiting, *chunks]))
        time_ns = chunk.times_ns(table)
        if self._part not in self._parts.names:
            self._vanished(time_ns, told)
            return told, PartState(self._fingerprint, None, None, 0)
        opening = earliest([None if state is None else state.opening, *openings])
        monitor, fresh = self._monitor(state, time_ns, watermark_ns, told)
        judged_until_ns = None if fresh else monitor.now_ns

        late = 0 if judged_until_ns is None else int(np.searchsorted(time_ns, judged_until_ns))
        if late and judged_until_ns is not None:
            told.lines.append(
                notices.late(self._plant, self._part, time_ns[:late].tolist(), judged_until_ns)
            )
        ready = max(late, int(np.searchsorted(time_ns, watermark_ns)))
        if ready > late:
            # What waited for another model is older than what is new.
            opening = earliest([opening, Opening(int(time_ns[late]), image=False)])
        begins = opening is not None and opening.time_ns < watermark_ns
        if fresh and begins and opening is not None and self._parts.several:
            # Its own rows may begin later than the plant's, or never: then it has stopped.
            monitor.begin(opening.time_ns, image=opening.image)
        if ready > late:
            self._observe(monitor, table.slice(late, ready - late), told)
        rest = table.slice(ready)
        wake_ms = self._wake_ms(monitor, rest, watermark_ns, opening, told)
        return told, PartState(
            self._fingerprint,
            monitor.state() if begins or not fresh else None,
            chunk.pack(rest) if len(rest) else None,
            wake_ms,
            opening if monitor.now_ns is None else None,
        )

    def _observe(self, monitor: Monitor, table: pa.Table, told: Told) -> None:
        rows = table.select(["time", "signal", "value"])
        begin = 0
        for gap in _gaps(table):
            told.take(monitor.observe(rows.slice(begin, gap - begin)), monitor)
            start_ns = int(table.column("value")[gap].as_py())
            end_ns = int(chunk.times_ns(table.slice(gap, 1))[0])
            of_gap = Told()
            of_gap.take(monitor.gap(start_ns, end_ns), monitor)
            if self._part != self._parts.first:
                # It is one finding, and another part tells it.
                of_gap.lines = [line for line in of_gap.lines if '"kind":"gap"' not in line]
            told.lines += of_gap.lines
            told.snapshots += of_gap.snapshots
            if self._parts.several:
                monitor.begin(end_ns, image=True)
            begin = gap + 1
        told.take(monitor.observe(rows.slice(begin)), monitor)

    def _nothing_to_do(
        self, state: PartState | None, chunks: Sequence[bytes], watermark_ns: int
    ) -> TypeGuard[PartState]:
        # Other parts of the plant had changes, and this one has been judged already.
        return (
            not chunks
            and state is not None
            and state.monitor is not None
            and state.model == self._fingerprint
            and state.wake_ms * MS > watermark_ns
        )

    def _wake_ms(
        self,
        monitor: Monitor,
        waiting: pa.Table,
        watermark_ns: int,
        opening: Opening | None,
        told: Told,
    ) -> int:
        if len(waiting):
            # The watermark is whole milliseconds, and must be beyond the change.
            return int(chunk.times_ns(waiting.slice(0, 1))[0]) // MS + 1
        now_ns = monitor.now_ns
        if now_ns is None:
            if opening is None or opening.time_ns >= watermark_ns:
                return max(watermark_ns, 0 if opening is None else opening.time_ns) // MS + 1
            now_ns = opening.time_ns
        # A plant whose changes lag behind the others' must not be judged up to the watermark while
        # they are under way; one that has been silent for a while has stopped.
        if watermark_ns - now_ns >= self._quiet_ns:
            told.take(monitor.advance(watermark_ns - 1), monitor)
            now_ns = watermark_ns
        return (now_ns + self._quiet_ns) // MS + 1

    def _monitor(
        self, state: PartState | None, time_ns: Any, watermark_ns: int, told: Told
    ) -> tuple[Monitor, bool]:
        if state is None or (state.model == self._fingerprint and state.monitor is None):
            return self._parts.monitor(self._part, None), True
        if state.model == self._fingerprint:
            try:
                return self._parts.monitor(self._part, state.monitor), False
            except RunglightError:
                # Saved by another version of the engine: as good as another model.
                pass
        since_ns = int(time_ns[0]) if len(time_ns) else watermark_ns
        told.lines.append(notices.replaced(self._plant, self._part, since_ns, self._fingerprint))
        return self._parts.monitor(self._part, None), True

    def _vanished(self, time_ns: Any, told: Told) -> None:
        if len(time_ns):
            told.lines.append(
                notices.vanished(self._plant, self._part, time_ns.tolist(), self._fingerprint)
            )


def _gaps(table: pa.Table) -> list[int]:
    signal = table.column("signal").combine_chunks()
    names = signal.dictionary.to_pylist()
    if GAP not in names:
        return []
    index = signal.indices.to_numpy(zero_copy_only=False)
    found: list[int] = np.flatnonzero(index == names.index(GAP)).tolist()
    return found
