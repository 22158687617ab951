"""The press's PLC program: one chart, watchdogs, and the alarm logic of its HMI."""

from collections.abc import Sequence
from operator import itemgetter

from runglight.plants.agenda import nanoseconds
from runglight.plants.press.chart import AT_START, STEPS
from runglight.plants.press.symbols import INPUTS, OUTPUTS

FILTER_NS = nanoseconds(0.1)
"""A sensor that should stay on may flicker for this long."""

SAFETY = (
    "Cabinet-E_STOP_OK",
    "Doors-FRONT_CLOSED",
    "Doors-REAR_CLOSED",
    "Doors-LEFT_CLOSED",
    "Doors-RIGHT_CLOSED",
    "Doors-LOCKED",
    "Doors-CURTAIN_OK",
)
"""Whoever opens a door or reaches in stops the machine; nothing is broken."""

MUST_BE_ON = (
    *(
        symbol.short_name
        for symbol in INPUTS
        if symbol.group == "Checks"
        and symbol.device not in ("OilPump", "Panel")
        and symbol.short_name not in SAFETY
        and not symbol.device.startswith("Reserve")
        and symbol.short_name != "Hydraulics-PRESSURE"
    ),
    "OilPump-TANK_OK",
    "Inverter-READY",
    "Inverter-NO_FAULT",
    "Infeed-MOTOR_OK",
    "Outfeed-MOTOR_OK",
)
"""Checks without which the machine stops at once."""

_NUMBER = {symbol.short_name: number for number, symbol in enumerate(INPUTS)}
_OUTPUT = {symbol.short_name: number for number, symbol in enumerate(OUTPUTS)}
_MANUAL, _RESET, _START, _STOP = (
    _NUMBER[f"Panel-{name}"] for name in ("KEY_MANUAL", "RESET", "START", "STOP")
)
_SAFETY = tuple(_NUMBER[name] for name in SAFETY)
_SAFE = itemgetter(*_SAFETY)
_MUST = tuple(_NUMBER[name] for name in MUST_BE_ON)
_UNTIL = tuple(tuple((_NUMBER[name], value) for name, value in step.until) for step in STEPS)
_HELD = tuple(tuple(_NUMBER[name] for name in step.held.values()) for step in STEPS)
_WATCHED = tuple(itemgetter(*_MUST, *held) for held in _HELD)


class PressController:
    """Call `scan` once per scan cycle. `jog` holds what an operator moves by hand at the HMI."""

    def __init__(self) -> None:
        self.step = 0
        self.cycles = 0
        self.manual = False
        self.alarm: str | None = None
        """The input the HMI shows, by its short name."""
        self.stopped: str | None = None
        """Why it stands although nothing is broken: an input, or `cycle stop`."""
        self.jog: dict[str, bool] = {}
        self.cycle_stop = False
        """The operator has asked to stop at the end of the cycle."""
        self.alarms: list[tuple[int, str]] = []
        """Every failure: when, and what the HMI showed."""
        self.stops: list[tuple[int, str]] = []
        """Every stop that is no failure: when, and why."""
        self._wanted = [False] * len(OUTPUTS)
        for name, value in AT_START.items():
            self._wanted[_OUTPUT[name]] = value
        self._entered_ns: int | None = None
        self._met_ns: int | None = None
        self._off_ns: dict[int, int] = {}
        self._ran_ns = 0
        self._settled = False

    @property
    def memory(self) -> tuple[bool, ...]:
        """Work complete, manual, alarm: "the machine has stopped working for any reason"."""
        return STEPS[self.step].work, self.manual, self._stands

    @property
    def settled(self) -> bool:
        """Whether the last scan left the program as it was."""
        return self._settled

    def next_timer_ns(self) -> int | None:
        """When the next running timer ends; None if none runs."""
        step = STEPS[self.step]
        due: list[int] = [since + FILTER_NS for since in self._off_ns.values()]
        if self._running:
            if self._met_ns is not None:
                due.append(self._met_ns + nanoseconds(step.pause_s))
            elif step.watchdog_s is not None and self._entered_ns is not None:
                due.append(self._entered_ns + nanoseconds(step.watchdog_s))
        return min((time for time in due if time > self._ran_ns), default=None)

    @property
    def _stands(self) -> bool:
        return self.alarm is not None or self.stopped is not None

    @property
    def _running(self) -> bool:
        return not self.manual and not self._stands

    def scan(self, inputs: Sequence[bool], now_ns: int) -> tuple[bool, ...]:
        """Runs the program once."""
        before = self._remembered
        self._ran_ns = now_ns
        if inputs[_MANUAL]:
            self.manual = True
            if inputs[_RESET]:
                self.alarm = None
                self.stopped = None
            self._entered_ns = None
            self._off_ns.clear()
        elif self.manual and inputs[_START]:
            self.manual = False
        elif self._may_go_on(inputs):
            self.stopped = None
        if self._running:
            self._check(inputs, now_ns)
        if self._running:
            self._run(inputs, now_ns)
        outputs = list(self._wanted)
        if self.manual:
            for name, value in self.jog.items():
                outputs[_OUTPUT[name]] = value
        self._settled = before == self._remembered
        return tuple(outputs)

    @property
    def _remembered(self) -> tuple[object, ...]:
        return (
            self.step, self.manual, self.alarm, self.stopped, self._met_ns, self._entered_ns
        )  # fmt: skip

    def _may_go_on(self, inputs: Sequence[bool]) -> bool:
        """Stops that end by themselves do; after the others START is pressed."""
        match self.stopped:
            case None:
                return False
            case "cycle stop":
                return not self.cycle_stop
            case "Infeed-WAITING":
                return inputs[_NUMBER["Infeed-WAITING"]]
            case _:
                return inputs[_START] and not inputs[_STOP] and all(_SAFE(inputs))

    def _check(self, inputs: Sequence[bool], now_ns: int) -> None:
        if inputs[_STOP]:
            self._stop("Panel-STOP", now_ns)
            return
        if not all(_SAFE(inputs)):
            off = next(number for number in _SAFETY if not inputs[number])
            self._stop(INPUTS[off].short_name, now_ns)
            return
        # Nearly always all is well.
        if not self._off_ns and all(_WATCHED[self.step](inputs)):
            return
        for number in (*_MUST, *_HELD[self.step]):
            if inputs[number]:
                self._off_ns.pop(number, None)
            elif now_ns - self._off_ns.setdefault(number, now_ns) >= FILTER_NS:
                self._raise_alarm(number, now_ns)
                return

    def _run(self, inputs: Sequence[bool], now_ns: int) -> None:
        step = STEPS[self.step]
        if self._entered_ns is None:
            if self.step == 0 and self.cycle_stop:
                self._stop("cycle stop", now_ns)
                return
            self._entered_ns = now_ns
            self._met_ns = None
            for name, value in step.switch.items():
                self._wanted[_OUTPUT[name]] = value
            self._off_ns.clear()
            return
        if self._met_ns is None:
            missing = [number for number, value in _UNTIL[self.step] if inputs[number] != value]
            if missing:
                watchdog_s = step.watchdog_s
                if watchdog_s and now_ns - self._entered_ns >= nanoseconds(watchdog_s):
                    if step.waits_for_parts:
                        self._stop(INPUTS[missing[0]].short_name, now_ns)
                    else:
                        self._raise_alarm(missing[0], now_ns)
                return
            self._met_ns = now_ns
        if now_ns - self._met_ns >= nanoseconds(step.pause_s):
            self.step = (self.step + 1) % len(STEPS)
            self.cycles += self.step == 0
            self._entered_ns = None
            self._met_ns = None
            self._off_ns.clear()

    def _raise_alarm(self, number: int, now_ns: int) -> None:
        self.alarm = INPUTS[number].short_name
        self.alarms.append((now_ns, self.alarm))
        self._forget()

    def _stop(self, why: str, now_ns: int) -> None:
        self.stopped = why
        self.stops.append((now_ns, why))
        self._forget()

    def _forget(self) -> None:
        self._entered_ns = None
        self._met_ns = None
        self._off_ns.clear()
