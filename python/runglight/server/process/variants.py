"""The runs of a log by what they do: how often, how long, and whether the net allows it."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

import msgspec
import numpy as np

from runglight.process.departures import Departure, departure
from runglight.process.token_walk import TokenWalk

if TYPE_CHECKING:
    from runglight.process.event_log import EventLog
    from runglight.process.petri_net import PetriNet

LISTED = 500
"""Variants told; the others are counted."""
EXPLAINED = 100
"""Variants for which is looked up where they depart."""
RUNS_LISTED = 200


class Variant(msgspec.Struct, frozen=True):
    """Runs that do the same in the same order."""

    runs: list[int]
    """Their numbers in the log, from 0; the first ones."""
    count: int
    share: float
    events: int
    seconds: float
    """Median length."""
    shortest_s: float
    longest_s: float
    fits: bool
    departs: Departure | None


def variants_of(log: EventLog, net: PetriNet) -> tuple[list[Variant], int]:
    """The variants, the commonest first, and how many there are."""
    activity, time_ns, bounds = (np.asarray(column) for column in log.columns())
    names = [name for name, _ in log.activities]
    by_order: dict[bytes, list[int]] = defaultdict(list)
    for run in range(log.traces):
        by_order[activity[bounds[run] : bounds[run + 1]].tobytes()].append(run)
    ordered = sorted(by_order.values(), key=lambda runs: (-len(runs), runs[0]))
    walk = TokenWalk(net)
    found: list[Variant] = []
    for runs in ordered[:LISTED]:
        first, end = int(bounds[runs[0]]), int(bounds[runs[0] + 1])
        seconds = [
            float(time_ns[bounds[run + 1] - 1] - time_ns[bounds[run]]) / 1e9
            for run in runs
            if bounds[run + 1] > bounds[run]
        ] or [0.0]
        fits = net.fitness(log.select([runs[0]])).fitting == 1
        why = None
        if not fits and len(found) < EXPLAINED:
            why = departure(walk, net, [names[number] for number in activity[first:end]])
        found.append(
            Variant(
                runs=runs[:RUNS_LISTED],
                count=len(runs),
                share=len(runs) / log.traces,
                events=end - first,
                seconds=float(np.median(seconds)),
                shortest_s=min(seconds),
                longest_s=max(seconds),
                fits=fits,
                departs=why,
            )
        )
    return found, len(ordered)
