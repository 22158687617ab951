"""The press at work without an end, with failures, variations and stops brought on meanwhile."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial

from runglight.plants.agenda import nanoseconds
from runglight.plants.faults import FaultDescription, FaultKind, FaultLabel, find_fault, label_of
from runglight.plants.press.chart import AT_START
from runglight.plants.press.controller import PressController
from runglight.plants.press.faults import FAILURES, FAULTS
from runglight.plants.press.operator import Operator
from runglight.plants.press.plant import PressPlant, Wear
from runglight.plants.press.symbols import OUTPUTS, SYMBOLS
from runglight.plants.scanned import ScannedPlant

GLITCH_S = 0.5
GLITCH_AFTER_S = 1.2
"""A sensor drops out this long after it has arrived: its step is over, and it has to hold."""

GLITCH_TOLD_S = 5.0
"""An alarm so long after a sensor dropped out has another cause."""


@dataclass(slots=True)
class _Injected:
    fault: FaultDescription
    armed_ns: int
    began_ns: int | None = None
    shown_ns: int | None = None
    passed: bool = False


class RunningPress(ScannedPlant[bool]):
    """A `RunningPlant`: the press, with an operator who mends what broke after each alarm."""

    def __init__(self, start_ns: int, seed: int = 1) -> None:
        self._plant = PressPlant(start_ns, seed)
        self._controller = PressController()
        self._operator = Operator(
            self._plant.agenda,
            self._plant,
            self._controller,
            self._mend,
            self._plant.random("operator"),
        )
        super().__init__(
            SYMBOLS,
            self._plant,
            self._controller,
            start_ns=start_ns,
            outputs=tuple(AT_START.get(symbol.short_name, False) for symbol in OUTPUTS),
            memory=lambda: self._controller.memory,
        )
        self._injected: list[_Injected] = []
        self._alarms_seen = 0
        self._plant.listeners.append(self._hear)

    @property
    def faults(self) -> Mapping[int, FaultDescription]:
        """The failures of the press."""
        return FAULTS

    @property
    def cycles(self) -> int:
        """Cycles of work and set-up completed."""
        return self._controller.cycles

    @property
    def alarms(self) -> tuple[tuple[int, str], ...]:
        """Every failure the HMI showed: when, and the input it names."""
        return tuple(self._controller.alarms)

    @property
    def stops(self) -> tuple[tuple[int, str], ...]:
        """Every stop with the alarm bit ON that is no failure: when, and why."""
        return tuple(self._controller.stops)

    def inject(self, fault: int | str, at_ns: int | None = None) -> FaultDescription:
        """Breaks something at the next possible moment after `at_ns` (None: now)."""
        chosen = find_fault(FAULTS, fault)
        if any(each.fault is chosen and not each.passed for each in self._injected):
            raise ValueError(f"fault {chosen.number} {chosen.name} is there already")
        armed_ns = self.now_ns if at_ns is None else max(at_ns, self.now_ns)
        injected = _Injected(chosen, armed_ns)
        self._injected.append(injected)
        self._plant.agenda.after(
            armed_ns - self._plant.agenda.now_ns, partial(self._try_to_begin, injected)
        )
        return chosen

    def labels(self) -> tuple[FaultLabel, ...]:
        """The truth about every failure that has begun."""
        return tuple(
            label_of(each.fault, each.began_ns, each.shown_ns)
            for each in self._injected
            if each.began_ns is not None
        )

    def waiting(self) -> tuple[FaultDescription, ...]:
        """Failures injected that have not begun yet."""
        return tuple(each.fault for each in self._injected if each.began_ns is None)

    def acting(self) -> tuple[FaultDescription, ...]:
        """Failures that have begun and are not mended."""
        return tuple(
            each.fault for each in self._injected if each.began_ns is not None and not each.passed
        )

    # what is no failure

    def intervene(self) -> None:
        """An operator takes the machine into manual, moves something, and starts it again."""
        self._operator.come(0.0)

    def reach_in(self, for_s: float = 2.0) -> None:
        """Somebody reaches through the light curtain; the press stops until START is pressed."""
        self._stop("Doors-CURTAIN_OK", False, for_s)

    def open_door(self, for_s: float = 60.0) -> None:
        """Somebody opens the front door: chips, a look at a part."""
        self._stop("Doors-FRONT_CLOSED", False, for_s)

    def press_stop(self, for_s: float = 0.5) -> None:
        """Somebody presses STOP."""
        self._stop("Panel-STOP", True, for_s)

    def press_emergency_stop(self, for_s: float = 30.0) -> None:
        """The emergency stop is pressed and pulled out again: by mistake, or to try it."""
        self._stop("Cabinet-E_STOP_OK", False, for_s)

    def _stop(self, sensor: str, value: bool, for_s: float) -> None:
        # The machine may have stood still since its last event.
        self._plant.advance(self.now_ns)
        self._operator.stop(sensor, value, for_s)

    def wear_out(self, device: str, over_s: float) -> None:
        """A cylinder's end cushion wears out from now on, and has failed after `over_s`.

        It rebounds from its end ever more often and for ever longer, until the sensor drops out
        for so long that the machine stops. Whoever mends then, changes it.
        """
        cylinder = self._plant.cylinders[device]
        cylinder.wear = Wear(self._plant.agenda.now_ns, nanoseconds(over_s))

    def vary(self, device: str, slow_factor: float = 1.35) -> None:
        """The next motion of a cylinder is slower, within what the watchdogs allow."""
        cylinder = self._plant.cylinders[device]
        cylinder.slow_factor = slow_factor
        self._plant.agenda.after(nanoseconds(60.0), partial(setattr, cylinder, "slow_factor", 1.0))

    def bounce(self, device: str) -> None:
        """The sensor that a cylinder next arrives at flickers for a few hundredths of a second."""
        self._plant.cylinders[device].bounces = True

    def stop_at_end_of_cycle(self, for_s: float) -> None:
        """An operator asks for a stop at the end of the cycle: a break, a change of shift."""
        self._controller.cycle_stop = True
        self._plant.agenda.after(nanoseconds(for_s), self._go_on)

    def starve(self, for_s: float) -> None:
        """No parts come for a while."""
        self._plant.feeder_stopped = True
        self._plant.agenda.after(
            nanoseconds(for_s), partial(setattr, self._plant, "feeder_stopped", False)
        )

    def sample(
        self,
        time_ns: int,
        inputs: tuple[int, ...],
        outputs: tuple[int, ...],
        memory: tuple[int, ...] = (),
    ) -> None:
        """The scan cycle shows its images; an alarm calls the operator."""
        super().sample(time_ns, inputs, outputs, memory)
        if len(self._controller.alarms) > self._alarms_seen:
            self._alarms_seen = len(self._controller.alarms)
            for each in self._injected:
                if each.began_ns is None or each.passed or each.shown_ns is not None:
                    continue
                glitch = each.fault.kind is FaultKind.SENSOR_GLITCH
                if not glitch or time_ns - each.began_ns < nanoseconds(GLITCH_TOLD_S):
                    each.shown_ns = time_ns
            self._operator.come()

    def _go_on(self) -> None:
        self._controller.cycle_stop = False
        # The program looks again at its next scan.
        self._plant.set("Panel-LAMPS_OK", True)

    def _hear(self, name: str, value: bool) -> None:
        for each in self._injected:
            if each.began_ns is None and self._plant.agenda.now_ns >= each.armed_ns:
                if FAILURES[each.fault.number].target == name:
                    self._plant.agenda.after(0, partial(self._try_to_begin, each))
                elif each.fault.kind in (FaultKind.ACTUATOR_DEAD, FaultKind.ACTUATOR_SLOW):
                    self._try_to_begin(each)

    def _try_to_begin(self, injected: _Injected) -> None:
        """Begins where its moment has come; else it is tried again when its target moves."""
        if injected.began_ns is not None:
            return
        target = FAILURES[injected.fault.number].target
        plant = self._plant
        match injected.fault.kind:
            case FaultKind.SENSOR_DEAD:
                if plant.is_true(target):
                    return
                plant.force(target, False)
            case FaultKind.SENSOR_STUCK_ON:
                if not plant.is_true(target):
                    return
                plant.force(target, True)
            case FaultKind.SENSOR_GLITCH:
                if not plant.is_true(target):
                    return
                plant.agenda.after(nanoseconds(GLITCH_AFTER_S), partial(plant.force, target, False))
                plant.agenda.after(
                    nanoseconds(GLITCH_AFTER_S + GLITCH_S), partial(plant.release, target)
                )
            case FaultKind.ACTUATOR_DEAD:
                plant.cylinders[target].dead = True
            case FaultKind.ACTUATOR_SLOW:
                plant.cylinders[target].slow_factor = 10.0
            case FaultKind.JAM:
                plant.jammed.add(target)
            case _:
                plant.force(target, False)
        injected.began_ns = plant.agenda.now_ns

    def _mend(self) -> None:
        for cylinder in self._plant.cylinders.values():
            if cylinder.wear is not None and cylinder.wear.share(self._plant.agenda.now_ns) >= 1.0:
                cylinder.wear = None
        for each in self._injected:
            if each.began_ns is None or each.passed or each.shown_ns is None:
                continue
            each.passed = True
            target = FAILURES[each.fault.number].target
            match each.fault.kind:
                case FaultKind.ACTUATOR_DEAD:
                    self._plant.cylinders[target].dead = False
                case FaultKind.ACTUATOR_SLOW:
                    self._plant.cylinders[target].slow_factor = 1.0
                case FaultKind.JAM:
                    self._plant.clear(target)
                case FaultKind.SENSOR_GLITCH:
                    pass
                case _:
                    self._plant.release(target)
        self._plant.follow_outputs()
