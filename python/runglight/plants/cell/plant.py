"""The cell's machine: part loader, Daecha with its clamps, two robots, and the parts.

Ghosh 2016, Figure 2 and section 3.1. It knows nothing of the program that drives it.
"""

from collections.abc import Callable, Sequence
from enum import Enum, auto
from functools import partial
from random import Random

from runglight.plants.agenda import Agenda, nanoseconds
from runglight.plants.cell.feeding import PartFeed
from runglight.plants.cell.symbols import INPUTS, OUTPUTS
from runglight.plants.field_wiring import ActuatorHealth, SensorCard
from runglight.plants.machinery import Axis, Drive, Robot, Task

PART_JITTER_S = 0.25
"""A part comes up to this much before or after its interval."""


class Moment(Enum):
    """What physically happens in a cycle; faults begin at such moments."""

    POWER_ON = auto()
    PART_SET = auto()
    LOADER_ADVANCING = auto()
    LOADER_HOME = auto()
    LOADER_RETURNING = auto()
    ROBOT_1_PICKING = auto()
    ROBOT_1_MOVING = auto()
    ROBOT_1_PLACED = auto()
    DAECHA_ADVANCING = auto()
    DAECHA_RETURNING = auto()


Listener = Callable[[Moment, int], None]


class CellPlant:
    """The machine at work: `advance` it in time, `read_inputs`, `write_outputs`.

    `feed` says how long after the loader stands home and empty each part is set on it. Listeners
    hear every moment, with the number of its cycle (from 1; a cycle begins with its part, the
    first with the start).
    """

    def __init__(self, start_ns: int, seed: int, feed: PartFeed) -> None:
        self.agenda = Agenda(start_ns)
        self.sensors = SensorCard([symbol.short_name for symbol in INPUTS])
        self.health = {symbol.short_name: ActuatorHealth() for symbol in OUTPUTS}
        self.listeners: list[Listener] = []
        self.feed = feed
        self.parts_set = 0
        self.parts_removed = 0
        self._outputs = dict.fromkeys(self.health, False)
        self._seed = seed
        self._feeding = self._random("feeder")
        self._unloading = self._random("unloader")
        self._part_on_loader = False
        self._part_in_gripper = False
        self._part_on_daecha = False
        self._loader_home = True
        self._daecha_away = False
        self._open_clamps = {1, 2}
        for name in ("PrtLDR-RET", "DCHA-RET", "RBT1-HOME_POS", "RBT2-HOME_POS"):
            self.sensors.set(name, True)
        for clamp in self._open_clamps:
            self.sensors.set(f"DCLAMP-OpSen{clamp}", True)

        self._loader = self._carriage("PrtLDR", 6.0, self._loader_at_home, self._loader_at_end)
        self._daecha = self._carriage("DCHA", 4.0, self._daecha_at_home, self._daecha_at_end)
        # the right clamp hangs on the longer hose: it starts later, and moves slower
        self._clamps = (
            self._clamp(1, travel_s=1.2, shortest_response_s=0.012, longest_response_s=0.037),
            self._clamp(2, travel_s=1.32, shortest_response_s=0.095, longest_response_s=0.120),
        )
        self._robot_1 = Robot(self.agenda, self._random("RBT1"), stage="home")
        self._robot_1.teach(self._robot_1_tasks())
        self._robot_2 = Robot(self.agenda, self._random("RBT2"), stage="home")
        self._robot_2.teach(self._robot_2_tasks())

    # the PLC's side

    def power_on(self) -> None:
        """The shift begins: call once, before the first scan."""
        self._tell(Moment.POWER_ON)
        self._await_part()

    def advance(self, now_ns: int) -> None:
        """Lets the machine move on to `now_ns`."""
        self.agenda.advance(now_ns)

    def read_inputs(self) -> tuple[bool, ...]:
        """What the sensors report now, in the order of `INPUTS`."""
        return self.sensors.read()

    def write_outputs(self, outputs: Sequence[bool]) -> None:
        """Switches the actuators now; in the order of `OUTPUTS`."""
        self._outputs = dict(zip(self.health, outputs, strict=True))
        self.follow_outputs()

    def next_event_ns(self) -> int | None:
        """When the machine next changes by itself; None while nothing moves or will move."""
        return self.agenda.next_ns()

    def follow_outputs(self) -> None:
        """Lets every actuator follow its output; also after its health changed."""
        on = self._outputs
        self._loader.command(on["PrtLDR-FORWARD"], on["PrtLDR-BACKWARD"])
        self._daecha.command(on["DCHA-FORWARD"], on["DCHA-BACKWARD"])
        for clamp in self._clamps:
            clamp.command(on["DCLAMP-CLOSE"], on["DCLAMP-OPEN"])
        self._robot_1.command(on)
        self._robot_2.command(on)

    @property
    def finished(self) -> bool:
        """Whether every part has come and gone."""
        return self.parts_removed == self.feed.parts

    # building

    def _random(self, part: str) -> Random:
        """Every part draws its own numbers, so that a fault of one leaves the others' alone."""
        return Random(f"{self._seed}/{part}")

    def _carriage(
        self,
        device: str,
        travel_s: float,
        on_home: Callable[[bool], None],
        on_away: Callable[[bool], None],
    ) -> Axis:
        outward, homeward = (
            Drive(travel_s, 0.022, 0.043, self.health[f"{device}-{output}"])
            for output in ("FORWARD", "BACKWARD")
        )
        return Axis(
            self.agenda,
            self._random(device),
            outward=outward,
            homeward=homeward,
            on_home=on_home,
            on_away=on_away,
        )

    def _clamp(
        self, number: int, travel_s: float, shortest_response_s: float, longest_response_s: float
    ) -> Axis:
        close, open_ = (
            Drive(
                travel_s,
                shortest_response_s,
                longest_response_s,
                self.health[f"DCLAMP-{output}"],
            )
            for output in ("CLOSE", "OPEN")
        )
        return Axis(
            self.agenda,
            self._random(f"DCLAMP{number}"),
            outward=close,
            homeward=open_,
            on_home=partial(self._clamp_opened, number),
            on_away=partial(self.sensors.set, f"DCLAMP-ClsSen{number}"),
        )

    def _robot_1_tasks(self) -> dict[str, Task]:
        on, off = (partial(self._report, "RBT1", value) for value in (True, False))
        return {
            "RBT1-PRT_PICK": Task(
                "home",
                (
                    (0.0, partial(self._tell, Moment.ROBOT_1_PICKING)),
                    (0.15, partial(on, "RUNNING")),
                    (0.40, partial(off, "HOME_POS")),
                    (4.60, self._pick_up_part),
                    (5.00, self._report_picked),
                ),
                self.health["RBT1-PRT_PICK"],
            ),
            "RBT1-PRT_MOVE": Task(
                "picked",
                (
                    (0.0, partial(self._tell, Moment.ROBOT_1_MOVING)),
                    (15.85, self._place_part),
                ),
                self.health["RBT1-PRT_MOVE"],
            ),
            "RBT1-RET_HOME": Task(
                "placed",
                (
                    (0.2, partial(off, "1ST_WORK_COMP")),
                    (0.4, partial(off, "2ND_WORK_COMP")),
                    (4.0, partial(on, "HOME_POS")),
                    (4.2, partial(off, "RUNNING")),
                    (4.2, lambda: self._robot_1.finish("home")),
                ),
                self.health["RBT1-RET_HOME"],
            ),
        }

    def _robot_2_tasks(self) -> dict[str, Task]:
        on, off = (partial(self._report, "RBT2", value) for value in (True, False))
        return {
            "RBT2-SEAL": Task(
                "home",
                (
                    (0.15, partial(on, "RUNNING")),
                    (0.40, partial(off, "HOME_POS")),
                    (8.00, partial(on, "WORK_COMP")),
                    (8.00, lambda: self._robot_2.finish("sealed")),
                ),
                self.health["RBT2-SEAL"],
            ),
            "RBT2-RET_HOME": Task(
                "sealed",
                (
                    (0.2, partial(off, "WORK_COMP")),
                    (3.0, partial(on, "HOME_POS")),
                    (3.2, partial(off, "RUNNING")),
                    (3.2, lambda: self._robot_2.finish("home")),
                ),
                self.health["RBT2-RET_HOME"],
            ),
        }

    # what happens

    def _tell(self, moment: Moment) -> None:
        for listener in tuple(self.listeners):  # one that has heard enough leaves
            listener(moment, max(self.parts_set, 1))

    def _report(self, device: str, value: bool, signal: str) -> None:
        self.sensors.set(f"{device}-{signal}", value)

    def _await_part(self) -> None:
        interval_s = None if self._part_on_loader else self.feed.interval_s(self.parts_set)
        if interval_s is None:
            return
        jitter_s = self._feeding.uniform(-PART_JITTER_S, PART_JITTER_S)
        self.agenda.after(nanoseconds(interval_s + jitter_s), self._set_part)

    def _set_part(self) -> None:
        if self._part_on_loader or not self._loader_home:
            return
        self._part_on_loader = True
        self.parts_set += 1
        self.sensors.set("PrtLDR-PRT_CHK", True)
        self._tell(Moment.PART_SET)

    def _loader_at_home(self, home: bool) -> None:
        self._loader_home = home
        self.sensors.set("PrtLDR-RET", home)
        if home:
            self._tell(Moment.LOADER_HOME)
            self._await_part()
        else:
            self._tell(Moment.LOADER_ADVANCING)

    def _loader_at_end(self, at_end: bool) -> None:
        self.sensors.set("PrtLDR-ADV", at_end)
        if not at_end:
            self._tell(Moment.LOADER_RETURNING)

    def _daecha_at_home(self, home: bool) -> None:
        self.sensors.set("DCHA-RET", home)
        if not home:
            self._tell(Moment.DAECHA_ADVANCING)

    def _daecha_at_end(self, at_end: bool) -> None:
        self._daecha_away = at_end
        self.sensors.set("DCHA-ADV", at_end)
        if not at_end:
            self._tell(Moment.DAECHA_RETURNING)
        self._unload()

    def _clamp_opened(self, number: int, opened: bool) -> None:
        (self._open_clamps.add if opened else self._open_clamps.discard)(number)
        self.sensors.set(f"DCLAMP-OpSen{number}", opened)
        self._unload()

    def _pick_up_part(self) -> None:
        """The gripper takes what lies on the loader; it may take nothing."""
        self._part_in_gripper = self._part_on_loader
        self._part_on_loader = False
        self.sensors.set("PrtLDR-PRT_CHK", False)

    def _report_picked(self) -> None:
        """A robot with an empty gripper reports nothing, and waits for help."""
        if self._part_in_gripper:
            self._report("RBT1", True, "1ST_WORK_COMP")
            self._robot_1.finish("picked")

    def _place_part(self) -> None:
        self._part_in_gripper = False
        self._part_on_daecha = True
        self._report("RBT1", True, "2ND_WORK_COMP")
        self._tell(Moment.ROBOT_1_PLACED)
        self._robot_1.finish("placed")

    def _unload(self) -> None:
        """Someone takes the part from the Daecha's far end, a moment after the clamps let go."""
        if self._part_on_daecha and self._daecha_away and len(self._open_clamps) == 2:
            self._part_on_daecha = False
            delay_s = self._unloading.uniform(1.2, 1.8)
            self.agenda.after(nanoseconds(delay_s), self._part_gone)

    def _part_gone(self) -> None:
        self.parts_removed += 1
