"""Simulated plants as logs: the part to learn from, the part to watch, and the truth."""

from dataclasses import dataclass
from functools import cached_property

import runglight as rl
from runglight.injection import InjectionLabel
from runglight.plants.bodyshop import BodyshopRun, simulate_bodyshop
from runglight.plants.cell import simulate_cell
from runglight.plants.faults import Transition
from runglight.plants.run import PlantRun

SECONDS_A_DAY = 86_400.0


@dataclass(frozen=True)
class Bodyshop:
    """One run of a body shop."""

    run: BodyshopRun
    learn: rl.Log
    watch: rl.Log

    @cached_property
    def waits(self) -> frozenset[Transition]:
        """The transitions that wait for an event of another device."""
        return frozenset(each for wait in self.run.triggers for each in wait.transitions)

    @cached_property
    def after(self) -> dict[Transition, str]:
        """What each transition of a device comes after."""
        return {times.transition: times.after for times in self.run.cycle_times}

    @cached_property
    def works(self) -> frozenset[Transition]:
        """The transitions that take what people or material take."""
        return frozenset(each for each, after in self.after.items() if after == "people")

    def waiting(self, label: InjectionLabel) -> bool:
        """True where the label's transition waits for another device."""
        return (label.from_state, label.to_state) in self.waits

    def of_people(self, label: InjectionLabel) -> bool:
        """True where people or material take the time they take."""
        return (label.from_state, label.to_state) in self.works


def bodyshop(
    size: str, seed: int, learn_events: int | None = None, watch_events: int | None = None
) -> Bodyshop:
    """Simulates one."""
    run = simulate_bodyshop(size, seed, learn_events, watch_events)
    return Bodyshop(run, log_of(run.learn), log_of(run.watch))


def cell(cycles: int, seed: int) -> rl.Log:
    """The log of a sound cell."""
    return log_of(simulate_cell(cycles=cycles, seed=seed))


def log_of(run: PlantRun) -> rl.Log:
    """What a logger saw."""
    return rl.Log.from_columns(run.time_ns, run.signal_index, run.value, run.signals)


def split(log: rl.Log, share: float) -> tuple[rl.Log, rl.Log]:
    """The first share of the rows, and the rest."""
    first = round(share * len(log))
    return log.slice(0, first), log.slice(first)


def days(log: rl.Log) -> float:
    """How long a log lasts."""
    start, end = log.engine.start_ns, log.engine.end_ns
    return 0.0 if start is None or end is None else (end - start) / 1e9 / SECONDS_A_DAY
