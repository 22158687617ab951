"""Who stands at the press: comes after an alarm, mends, jogs, resets and starts it again."""

from collections.abc import Callable
from functools import partial
from random import Random

from runglight.plants.agenda import Agenda, nanoseconds
from runglight.plants.press.controller import PressController
from runglight.plants.press.plant import PressPlant
from runglight.plants.press.symbols import ACTUATOR_NAMES

MOVABLE = tuple(name for name in ACTUATOR_NAMES if name not in ("Stop1", "Grip1", "Grip2"))
"""What an operator moves without losing a part."""

JOG_S = 3.0
"""A jogged cylinder goes there and back within this time each way."""


class Operator:
    """Acts on the panel and the HMI only; `mend` is called with the machine in manual."""

    def __init__(
        self,
        agenda: Agenda,
        plant: PressPlant,
        controller: PressController,
        mend: Callable[[], None],
        random: Random,
    ) -> None:
        self.busy = False
        self._agenda = agenda
        self._plant = plant
        self._controller = controller
        self._mend = mend
        self._random = random

    def come(self, in_s: float | None = None) -> None:
        """Comes to the press in a while (after an alarm: one to five minutes)."""
        if self.busy:
            return
        self.busy = True
        wait_s = self._random.uniform(60.0, 300.0) if in_s is None else in_s
        self._later(wait_s, partial(self._plant.set, "Panel-KEY_MANUAL", True))
        at_s = wait_s + self._random.uniform(5.0, 60.0)
        self._later(at_s, self._mend)
        at_s += self._random.uniform(10.0, 30.0)
        for _ in range(self._random.randrange(4)):
            name = self._random.choice(MOVABLE)
            self._later(at_s, partial(self._jog, name))
            at_s += JOG_S
            self._later(at_s, self._controller.jog.clear)
            at_s += JOG_S
        self._later(at_s, partial(self._plant.set, "Panel-RESET", True))
        self._later(at_s + 0.4, partial(self._plant.set, "Panel-RESET", False))
        self._later(at_s + 2.0, partial(self._plant.set, "Panel-KEY_MANUAL", False))
        self._later(at_s + 3.0, partial(self._plant.set, "Panel-START", True))
        self._later(at_s + 3.4, partial(self._plant.set, "Panel-START", False))
        self._later(at_s + 3.5, self._gone)

    def stop(self, sensor: str, value: bool, for_s: float) -> None:
        """Reaches in, opens a door or presses a button: the sensor holds `value` for a while.

        Then START is pressed, without the key.
        """
        if self.busy:
            return
        self.busy = True
        self._later(0.0, partial(self._plant.set, sensor, value))
        self._later(for_s, partial(self._plant.set, sensor, not value))
        self._later(for_s + 1.0, partial(self._plant.set, "Panel-START", True))
        self._later(for_s + 1.4, partial(self._plant.set, "Panel-START", False))
        self._later(for_s + 1.5, self._gone)

    def _later(self, seconds: float, action: Callable[[], object]) -> None:
        self._agenda.after(nanoseconds(seconds), lambda: _call(action))

    def _jog(self, name: str) -> None:
        valve = f"{name}-VALVE"
        self._controller.jog[valve] = not self._plant.is_on(valve)

    def _gone(self) -> None:
        self.busy = False
        if self._controller.alarm is not None:
            self.come()


def _call(action: Callable[[], object]) -> None:
    action()
