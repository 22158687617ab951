"""How long one transition took, every time it was seen."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import msgspec

if TYPE_CHECKING:
    from collections.abc import Mapping

    from runglight import _engine

AT_MOST = 5000
"""Newest instances that are given."""
EDGES_AT_MOST = 400_000


class Instance(msgspec.Struct, frozen=True, array_like=True):
    """One passing: when it ended, and how long it took."""

    at_ms: float
    took_s: float


def transition_times(
    diagram: _engine.TimingDiagram,
    lanes: Mapping[int, str],
    *,
    current: tuple[str, int],
    following: tuple[str, int],
    start_ns: int,
    until_ns: int,
) -> list[Instance]:
    """Passings from one signal-state to the next among the events of some lanes, oldest first.

    `lanes` are those of one device (for a group's chain, the starting signals of its devices) with
    the full names of their signals. Rows of one scan are taken in the order of the lanes, which is
    not always the model's: what two signals did in one scan may be left out.
    """
    events: list[tuple[int, str, int]] = []
    for lane, name in lanes.items():
        edges = diagram.edges(lane, start_ns, until_ns, EDGES_AT_MOST)
        # The first row of a lane says how it stood, not that it changed.
        events += [(time_ns, name, value) for time_ns, value in edges[1:]]
    events.sort(key=lambda event: event[0])
    return [
        Instance(time_ns / 1e6, (time_ns - before_ns) / 1e9)
        for (before_ns, *before), (time_ns, *after) in pairwise(events)
        if tuple(before) == current and tuple(after) == following
    ][-AT_MOST:]
