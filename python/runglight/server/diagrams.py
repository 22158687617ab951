"""Timing diagrams of recordings and logs: read once, kept for the next look."""

from __future__ import annotations

import asyncio
from collections import OrderedDict
from dataclasses import dataclass
from typing import TYPE_CHECKING

from runglight import _engine
from runglight.log.changelog import read_log_with
from runglight.recording.read import open_recording

if TYPE_CHECKING:
    from pathlib import Path

    from runglight.log.options import ReadOptions
    from runglight.server.catalogue import Item

KEPT_ROWS = 30_000_000
"""About half a gigabyte; the diagram looked at last is kept in any case."""


@dataclass(frozen=True, slots=True)
class Diagram:
    """A log as it is drawn."""

    diagram: _engine.TimingDiagram
    signals: list[str]
    start_ns: int
    until_ns: int
    gaps: list[tuple[int, int]]
    rows: int
    addresses: dict[str, str]


class Diagrams:
    """Diagrams by item; reading happens in threads, and never twice at once."""

    def __init__(self, options: ReadOptions) -> None:
        self._options = options
        self._kept: OrderedDict[tuple[str, float], Diagram] = OrderedDict()
        self._reading: dict[tuple[str, float], asyncio.Task[Diagram]] = {}

    async def of(self, item: Item) -> Diagram:
        """The diagram of a recording or a log; InputError where it cannot be read."""
        key = (item.id, changed_at(item.path))
        if key in self._kept:
            self._kept.move_to_end(key)
            return self._kept[key]
        if key not in self._reading:
            self._reading[key] = asyncio.create_task(asyncio.to_thread(self._read, item))
        try:
            diagram = await asyncio.shield(self._reading[key])
        finally:
            if (task := self._reading.get(key)) is not None and task.done():
                del self._reading[key]
        self._kept[key] = diagram
        for older in [each for each in self._kept if each[0] == item.id and each != key]:
            del self._kept[older]
        while len(self._kept) > 1 and sum(each.rows for each in self._kept.values()) > KEPT_ROWS:
            self._kept.popitem(last=False)
        return diagram

    def _read(self, item: Item) -> Diagram:
        addresses: dict[str, str] = {}
        if item.kind == "recording":
            recording = open_recording(item.path, scans=False)
            log, until_ns = recording.log, recording.until_ns
            addresses = {each.name: each.address for each in recording.description.signals}
        else:
            log, until_ns = read_log_with(item.path, self._options), 0
        engine = log.engine
        return Diagram(
            diagram=_engine.TimingDiagram(engine),
            signals=log.signals,
            start_ns=engine.start_ns or 0,
            until_ns=max(until_ns, engine.end_ns or 0),
            gaps=engine.gaps,
            rows=len(log),
            addresses=addresses,
        )


def changed_at(path: Path) -> float:
    """When what is read of a path last changed."""
    if path.is_file():
        return path.stat().st_mtime
    parts = [path / "tail.sqlite", path / "tail.sqlite-wal", path / "segments"]
    return max((part.stat().st_mtime for part in parts if part.exists()), default=0.0)
