"""What could be found of people's late work by whoever knew the law of every such time.

The body shop draws them doubly and halves the sum: on the way to its most, the probability of a
longer time falls with the square of what is left. Limits at one probability for all of them, so
that they are passed as often as alarms are allowed, are as good as limits get where nobody knows
which work is late. No log of ninety times tells the law so well.
"""

from math import inf, sqrt

import polars as pl

import runglight as rl
from benches.plants import Bodyshop
from runglight.injection import InjectionKind, InjectionLabel
from runglight.plants.faults import Transition


def limits_s(plant: Bodyshop, alarms: float) -> dict[Transition, float]:
    """The longest accepted time of each work of people, for so many alarms while watching."""
    alpha = alarms / max(_instances(plant), 1)
    ranges = {
        times.transition: times.times_s
        for times in plant.run.cycle_times
        if times.after == "people"
    }
    return {
        transition: max(most - (most - least) * sqrt(alpha / 2) for least, most in times_s)
        for transition, times_s in ranges.items()
    }


def found(limits: dict[Transition, float], labels: list[InjectionLabel]) -> int:
    """How many of the late works of people are beyond these limits."""
    return sum(_is_beyond(limits, label) for label in labels)


def _is_beyond(limits: dict[Transition, float], label: InjectionLabel) -> bool:
    if label.kind is not InjectionKind.LATE or not label.from_state or not label.to_state:
        return False
    limit_s = limits.get((label.from_state, label.to_state), inf)
    # It shows when the maximum passes, and comes so much later.
    return (label.time_ns - label.start_ns) / 1e9 + (label.size_s or 0.0) > limit_s


def _instances(plant: Bodyshop) -> int:
    """How often people's work is done in the watching part."""
    rules = pl.DataFrame(rl.learn(plant.watch, timing="plat").rules())
    counts = rules.filter(model="device").unique(["current", "next"])
    ways = zip(counts["current"], counts["next"], counts["count"], strict=True)
    return sum(count for current, following, count in ways if (current, following) in plant.works)
