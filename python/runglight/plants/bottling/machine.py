"""The bottling machine itself: rotary table, belt, filling nozzle, pick-and-place for caps."""

from collections.abc import Sequence
from functools import partial
from random import Random

from runglight.plants.agenda import Agenda, nanoseconds
from runglight.plants.bottling.belt import Belt, Bottle, Eye
from runglight.plants.bottling.scene import BottleSight, Happening, Scene, Sight
from runglight.plants.bottling.terminals import Input, Output
from runglight.plants.field_wiring import ActuatorHealth
from runglight.plants.machinery import Axis, Drive

STATION_1_M = 0.50
STATION_2_M = 0.85
STOPS_M = {"before 1": 0.30, "after 1": STATION_1_M, "station 2": STATION_2_M}
_STOPS = {Output.STOP_1: "before 1", Output.STOP_2: "after 1", Output.STOP_3: "station 2"}
_OPEN = {"before 1": Input.STOP_1_OPEN, "after 1": Input.STOP_2_OPEN}

LEFT_M = 0.91
"""A bottle so far has visibly left station 2."""

_EYES = {
    Input.PART_AT_STOP: Eye(0.28, 0.32),
    Input.PART_ON_STATION_1: Eye(0.48, 0.52),
    Input.PART_AFTER_STATION_1: Eye(0.56, 0.60),
    Input.PART_ON_STATION_2: Eye(0.83, 0.87),
    Input.PART_AT_EXIT: Eye(0.98, 1.02),
}
_LEFT = "left"

FULL_S = 1.45
"""The nozzle fills a bottle in about so long."""

GROUP_EVERY_S = (29.0, 38.5)
GROUP_OF_THREE = 0.25
"""Groups are of four bottles, this share of three: 3.75 in 33.75 s make 400 an hour."""

_ARM = partial(Drive, 0.42, 0.02, 0.05)


class BottlingMachine:
    """Call `advance`, `read_inputs`, `write_outputs`; `scene` is what a camera would see."""

    def __init__(self, start_ns: int, seed: int) -> None:
        self.agenda = Agenda(start_ns)
        self.sights: list[Sight] = []
        """What has happened for everybody to see, in time order."""
        self._seed = seed
        self._inputs = [False] * len(Input)
        self._on = [False] * len(Output)
        eyes = {str(int(number)): eye for number, eye in _EYES.items()}
        eyes[_LEFT] = Eye(LEFT_M, LEFT_M + 0.03)
        self._belt = Belt(self.agenda, STOPS_M, eyes, self._report)
        self._arm = Axis(
            self.agenda,
            self.random("arm"),
            outward=_ARM(ActuatorHealth()),
            homeward=_ARM(ActuatorHealth()),
            on_home=partial(self.set, Input.ARM_AT_PICK),
            on_away=partial(self.set, Input.ARM_AT_PLACE),
        )
        self.set(Input.ARM_AT_PICK, True)
        self._valves = self.random("valves")
        self._supply = self.random("supply")
        self._nozzle = self.random("nozzle")
        self._filling: tuple[Bottle, int, float] | None = None
        self._waiting = 0
        self._placing = False
        self.agenda.after(nanoseconds(1.0), self._bring_group)

    def random(self, part: str) -> Random:
        """Every part draws its own numbers."""
        return Random(f"{self._seed}/{part}")

    def advance(self, now_ns: int) -> None:
        """Lets the machine move on to `now_ns`."""
        self.agenda.advance(now_ns)

    def next_event_ns(self) -> int | None:
        """When the machine next changes by itself."""
        return self.agenda.next_ns()

    def read_inputs(self) -> tuple[bool, ...]:
        """What the sensors report now, in the order of `Input`."""
        return tuple(self._inputs)

    def set(self, number: Input, value: bool) -> None:
        """What a sensor or button says from now on."""
        self._inputs[number] = value

    def write_outputs(self, outputs: Sequence[bool]) -> None:
        """Switches motors, valves and lamps, in the order of `Output`."""
        before, self._on = self._on, list(outputs)
        for number, value in enumerate(outputs):
            if value != before[number]:
                self._switch(Output(number), value)
        self._arm.command(self._on[Output.ARM_TO_PLACE], self._on[Output.ARM_TO_PICK])

    def scene(self, now_ns: int) -> Scene:
        """What is to be seen, at most a scan after the last one. Looking changes nothing."""
        positions_m = self._belt.positions_at(now_ns)
        return Scene(
            time_ns=now_ns,
            bottles=tuple(
                BottleSight(position_m, self._filled(bottle, now_ns), bottle.capped)
                for bottle, position_m in zip(self._belt.bottles, positions_m, strict=True)
            ),
            travel_m=self._belt.travel_at(now_ns),
            open_stops=frozenset(stop for stop in STOPS_M if not self._belt.is_closed(stop)),
            filling=self._filling is not None,
            arm=self._arm.position_at(now_ns),
            holds_cap=self._inputs[Input.CAP_GRIPPED],
            green=self._on[Output.GREEN],
            orange=self._on[Output.ORANGE],
        )

    def _switch(self, output: Output, value: bool) -> None:
        response_ns = nanoseconds(self._valves.uniform(0.02, 0.06))
        match output:
            case Output.CONVEYOR:
                self.agenda.after(response_ns, partial(self._run, value))
            case Output.STOP_1 | Output.STOP_2 | Output.STOP_3:
                self.agenda.after(response_ns, partial(self._move_stop, _STOPS[output], value))
            case Output.SHUTTER:
                self.agenda.after(response_ns, partial(self._pour, value))
            case Output.GRIPPER:
                self.agenda.after(2 * response_ns, partial(self._grip, value))
            case Output.TABLE if value:
                self._turn_table()
            case _:
                pass

    def _run(self, running: bool) -> None:
        self.set(Input.CONTACTOR, running)
        self._belt.run(running)
        what = Happening.CONVEYOR_STARTS if running else Happening.CONVEYOR_STOPS
        self.sights.append(Sight(self.agenda.now_ns, what))

    def _move_stop(self, stop: str, is_open: bool) -> None:
        self._belt.close(stop, not is_open)
        if stop in _OPEN:
            self.set(_OPEN[stop], is_open)

    def _report(self, eye: str, sees: bool) -> None:
        if eye != _LEFT:
            self.set(Input(int(eye)), sees)
        elif sees:
            self.sights.append(Sight(self.agenda.now_ns, Happening.BOTTLE_LEAVES))

    def _pour(self, opens: bool) -> None:
        if self._filling is not None:
            bottle, _, _ = self._filling
            bottle.filled = self._filled(bottle, self.agenda.now_ns)
            self._filling = None
        below = self._belt.at(STATION_1_M)
        if opens and below is not None:
            rate_per_s = self._nozzle.uniform(0.96, 1.04) / FULL_S
            self._filling = (below, self.agenda.now_ns, rate_per_s)

    def _filled(self, bottle: Bottle, now_ns: int) -> float:
        if self._filling is None or self._filling[0] is not bottle:
            return bottle.filled
        _, since_ns, rate_per_s = self._filling
        return min(bottle.filled + rate_per_s * (now_ns - since_ns) * 1e-9, 1.0)

    def _grip(self, grips: bool) -> None:
        if grips:
            self.set(Input.CAP_GRIPPED, self._inputs[Input.ARM_AT_PICK])
            return
        bottle = self._belt.at(STATION_2_M)
        if self._inputs[Input.CAP_GRIPPED] and self._inputs[Input.ARM_AT_PLACE] and bottle:
            bottle.capped = True
        self.set(Input.CAP_GRIPPED, False)

    def _bring_group(self) -> None:
        """Somebody sets a group of bottles on the table, if it is empty."""
        if not self._waiting:
            self._waiting = 3 if self._supply.random() < GROUP_OF_THREE else 4
            self.set(Input.GROUP_READY, True)
        self.agenda.after(nanoseconds(self._supply.uniform(*GROUP_EVERY_S)), self._bring_group)

    def _turn_table(self) -> None:
        if not self._placing:
            self._placing = True
            self.agenda.after(nanoseconds(0.4), self._place_bottle)

    def _place_bottle(self) -> None:
        if not self._on[Output.TABLE] or not self._waiting:
            self._placing = False
            return
        if self._belt.place(Bottle()):
            self._waiting -= 1
        self.set(Input.GROUP_READY, self._waiting > 0)
        self.agenda.after(nanoseconds(self._supply.uniform(0.45, 0.6)), self._place_bottle)
