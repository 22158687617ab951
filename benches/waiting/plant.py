"""A plant in operation: its clock, its dice, its log, and the delays put into it."""

from collections.abc import Generator, Sequence
from dataclasses import dataclass, field
from itertools import count
from math import ceil
from random import Random
from typing import Any

import numpy as np
import simpy

import runglight as rl

Life = Generator[Any, Any, None]
"""What a device does, one wait after the other."""

TICK_S = 0.01
SPREAD = 0.01
"""Standard deviation of a motion, as a share of its mean."""
LATE_S = (1.0, 2.5)
LATE_SHARE = 0.012
"""Share of the motions that are delayed, in the part that is watched."""
LEARN_SHARE = 0.6
GROUPS = 3
STATIONS = 6


@dataclass(frozen=True)
class Delay:
    """A motion that was made late."""

    time_ns: int
    """When it ended."""
    device: str
    """The device that moved, with its group: `Line1-St3Robot`."""
    hidden: bool
    """True where it became as long as another usual time of this motion: no clock can tell."""


@dataclass
class Plant:
    """A plant in operation: its clock, its dice, its log."""

    seed: int
    events: int
    delayed: bool
    clock: simpy.Environment = field(default_factory=simpy.Environment)
    rows: list[tuple[int, str, int]] = field(default_factory=list)
    delays: list[Delay] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.draw = Random(self.seed)
        self._fate = Random(self.seed + 1)

    def set(self, signal: str, value: int) -> None:
        """A signal changes now."""
        self.rows.append((self._tick_ns(self.clock.now), signal, value))

    def pause(self, seconds: float) -> simpy.Event:
        """Time goes by."""
        return self.clock.timeout(seconds)

    def moves(
        self, seconds: float, ends: str | None = None, usual_s: Sequence[float] = ()
    ) -> simpy.Event:
        """A motion of the machine, which may be late where it is said what signal `ends` it.

        `usual_s` are the times it usually takes, this one among them.
        """
        took = max(TICK_S, self.draw.gauss(seconds, SPREAD * seconds))
        if ends and self._is_delayed():
            took += self._fate.uniform(*LATE_S)
            hidden = any(abs(took - usual) < 4 * SPREAD * usual for usual in usual_s)
            device = ends.rpartition("-")[0]
            self.delays.append(Delay(self._tick_ns(self.clock.now + took), device, hidden))
        return self.clock.timeout(took)

    def _is_delayed(self) -> bool:
        is_watched = len(self.rows) > LEARN_SHARE * self.events
        return self.delayed and is_watched and self._fate.random() < LATE_SHARE

    def starts(self, life: Life) -> None:
        """A device begins its life."""
        self.clock.process(life)

    def places(self, free: int) -> simpy.Container:
        """Room for some, of which so many are free."""
        return simpy.Container(self.clock, init=free)

    def run(self) -> tuple[rl.Log, rl.Log]:
        """The part to learn from, and the part to watch."""
        while len(self.rows) < self.events:
            self.clock.run(until=self.clock.now + 600)
        rows = self.rows[: self.events]
        self.delays = [delay for delay in self.delays if delay.time_ns <= rows[-1][0]]
        names = sorted({signal for _, signal, _ in rows})
        number = dict(zip(names, count(), strict=False))
        log = rl.Log.from_columns(
            np.array([time_ns for time_ns, _, _ in rows], np.int64),
            np.array([number[signal] for _, signal, _ in rows], np.uint32),
            np.array([value for _, _, value in rows], np.int64),
            names,
        )
        learned = round(LEARN_SHARE * len(log))
        return log.slice(0, learned), log.slice(learned)

    @staticmethod
    def _tick_ns(seconds: float) -> int:
        return ceil(seconds / TICK_S - 1e-9) * round(TICK_S * 1e9)
