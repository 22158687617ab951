"""Who works at the bottling machine: starts it, and now and then moves its belt by hand."""

from functools import partial
from math import inf

from runglight.plants.agenda import Action, nanoseconds
from runglight.plants.bottling.machine import BottlingMachine
from runglight.plants.bottling.terminals import Input

PRODUCTION_S = 300.0
"""Production, from one manual phase to the next."""

JOGS = (2, 4)
RUNS_S = (4.0, 14.0)
STANDS_S = (5.0, 14.0)
RESPITE_S = (3.0, 8.0)
"""From the selector to the first button, and from the last one to the selector."""
ACKNOWLEDGES_S = (4.0, 9.0)
"""From the selector to the start button: the guard is closed, the HMI asks whether all is well."""


class Operator:
    """`production_s` is how long the machine produces between two manual phases; inf: for ever."""

    def __init__(self, machine: BottlingMachine, production_s: float = PRODUCTION_S) -> None:
        self._machine = machine
        self._random = machine.random("operator")
        self._production_s = production_s
        self._press(0.5, Input.START)
        self._produce()

    def _produce(self) -> None:
        if self._production_s < inf:
            vary = self._random.uniform(0.85, 1.15)
            self._after(self._production_s * vary, self._take_over)

    def _take_over(self) -> None:
        self._machine.set(Input.SELECTOR_MANUAL, True)
        at_s = self._random.uniform(*RESPITE_S)
        for _ in range(self._random.randint(*JOGS)):
            runs_s = self._random.uniform(*RUNS_S)
            self._press(at_s, Input.JOG, runs_s)
            at_s += runs_s + self._random.uniform(*STANDS_S)
        self._after(at_s, self._hand_back)

    def _hand_back(self) -> None:
        self._machine.set(Input.SELECTOR_MANUAL, False)
        self._press(self._random.uniform(*ACKNOWLEDGES_S), Input.START)
        self._produce()

    def _press(self, after_s: float, button: Input, for_s: float = 0.4) -> None:
        self._after(after_s, partial(self._machine.set, button, True))
        self._after(after_s + for_s, partial(self._machine.set, button, False))

    def _after(self, seconds: float, action: Action) -> None:
        self._machine.agenda.after(nanoseconds(seconds), action)
