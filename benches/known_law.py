"""What could be found of people's late work by whoever knew the law of every such time.

The body shop draws them doubly and halves the sum: on the way to its most, the probability of a
longer time falls with the square of what is left. Limits at one probability for all of them, so
that they are passed as often as alarms are allowed, are as good as limits get where nobody knows
which work is late. No log of ninety times tells the law so well.
"""

from math import sqrt

import numpy as np

from benches.plants import Bodyshop
from runglight.injection import InjectionKind, InjectionLabel
from runglight.plants.faults import Transition


def limits_s(plant: Bodyshop, alarms: float) -> dict[Transition, float]:
    """The longest accepted time of each work of people, for so many alarms while watching."""
    instances = sum(_instances(plant).values())
    alpha = alarms / max(instances, 1)
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
    limit_s = limits.get((label.from_state, label.to_state), np.inf)
    # It shows when the maximum passes, and comes so much later.
    return (label.time_ns - label.start_ns) / 1e9 + (label.size_s or 0.0) > limit_s


def _instances(plant: Bodyshop) -> dict[Transition, int]:
    """How often each work of people is done in the watching part."""
    run = plant.run.watch
    name = [f"{signal}_{'ON' if value else 'OFF'}" for signal in run.signals for value in (0, 1)]
    code = {state: number for number, state in enumerate(name)}
    devices = np.array(["-".join(signal.split("-", 2)[:2]) for signal in run.signals])
    number = np.unique(devices, return_inverse=True)[1][run.signal_index]
    order = np.argsort(number, kind="stable")
    state = (2 * run.signal_index.astype(np.int64) + run.value)[order]
    of_one_device = np.diff(number[order]) == 0
    steps = (state[:-1] * len(name) + state[1:])[of_one_device]
    values, counts = np.unique(steps, return_counts=True)
    seen = dict(zip(values.tolist(), counts.tolist(), strict=True))
    return {
        (before, after): seen.get(code[before] * len(name) + code[after], 0)
        for before, after in plant.works
    }
