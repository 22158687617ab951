"""The PLC program of the bottling machine: modes, the two stations, counters."""

from collections.abc import Sequence
from random import Random

from runglight.plants.agenda import NS_PER_S
from runglight.plants.bottling.capping import SCREW_S, CappingStation
from runglight.plants.bottling.filling import FillingStation
from runglight.plants.bottling.steps import Steps
from runglight.plants.bottling.terminals import Input, Output

SLOW_NS = 100_000_000
"""Measurements and clocks are written by a task of its own, ten times a second."""

BLINK_NS = 2 * NS_PER_S
"""The green lamp blinks so long on, so long off, while the machine waits in manual."""

ORDER = 24_000
"""Bottles of the order."""

START_WARNING_S = 0.8
"""From the start button until the conveyor starts."""


class Mode:
    """Steps of the chart of modes."""

    MANUAL = 0
    READY = 1
    WARN = 2
    AUTOMATIC = 3


class BottlingProgram:
    """Call `scan` once per scan cycle."""

    def __init__(self, seed: int) -> None:
        self.inputs: Sequence[bool] = (False,) * len(Input)
        self.outputs: tuple[bool, ...] = (False,) * len(Output)
        self.modes = Steps()
        self.modes.enter(Mode.READY, 0)
        self.filling = FillingStation()
        self.capping = CappingStation()
        self.now_ns = 0
        self.produced = 0
        """Bottles that left the machine; a shift's counters begin with it."""
        self.produced_in_minute = 0
        self.rate_per_hour = 0
        self.torque = 0
        """Of the last cap, in tenths of a newton metre."""
        self.slow_tasks = 0
        self._random = Random(f"{seed}/program")
        self._fill_s = 1.5
        self._exit_before = False
        self._slow_due_ns: int | None = None
        self._tens: list[int] = []
        self._settled = False

    @property
    def automatic(self) -> bool:
        """The machine produces."""
        return self.modes.step == Mode.AUTOMATIC

    @property
    def settled(self) -> bool:
        """Whether the last scan left the program as it was."""
        return self._settled

    def next_timer_ns(self) -> int | None:
        """When the next running timer ends: at the latest, the slow task's."""
        due = (self.modes.due_ns, self.filling.steps.due_ns, self.capping.steps.due_ns)
        timers = [time_ns for time_ns in (*due, self._slow_due_ns) if time_ns is not None]
        return min(timers, default=None)

    def scan(self, inputs: Sequence[bool], now_ns: int) -> tuple[bool, ...]:
        """Runs the program once."""
        before = self._remembered()
        self.inputs, self.now_ns = inputs, now_ns
        self._choose_mode()
        self._fill()
        self.capping.scan(inputs, now_ns, running=self.automatic, screw_s=SCREW_S)
        self._count()
        if self._slow_due_ns is None or now_ns >= self._slow_due_ns:
            self._run_slow_task()
        self.outputs = self._switch()
        self._settled = before == self._remembered()
        return self.outputs

    def _remembered(self) -> tuple[object, ...]:
        """What decides what comes next; also the inputs, because the memory shows them."""
        return (
            tuple(self.inputs),
            self.modes.step,
            self.filling.steps.step,
            self.capping.steps.step,
            self.capping.expected,
            self.capping.grips,
            self.capping.to_pick,
            self.produced,
        )

    def _choose_mode(self) -> None:
        inputs, modes = self.inputs, self.modes
        match modes.step:
            case _ if inputs[Input.SELECTOR_MANUAL] and modes.step != Mode.MANUAL:
                modes.enter(Mode.MANUAL, self.now_ns)
            case Mode.MANUAL if not inputs[Input.SELECTOR_MANUAL]:
                modes.enter(Mode.READY, self.now_ns)
            case Mode.READY if inputs[Input.START]:
                modes.enter(Mode.WARN, self.now_ns)
            case Mode.WARN if modes.lasted(START_WARNING_S, self.now_ns):
                modes.enter(Mode.AUTOMATIC, self.now_ns)
            case _:
                pass

    def _fill(self) -> None:
        station, let_go = self.filling, self.filling.lets_go
        filled = station.filled
        station.scan(
            self.inputs,
            self.now_ns,
            running=self.automatic,
            next_free=self.capping.free,
            fill_s=self._fill_s,
        )
        if station.lets_go and not let_go:
            self.capping.expected = True
        if station.filled != filled:
            # The flow meter ends each filling: some bottles take a little longer.
            self._fill_s = self._random.uniform(1.42, 1.58)

    def _count(self) -> None:
        at_exit = self.inputs[Input.PART_AT_EXIT]
        if at_exit and not self._exit_before:
            self.produced += 1
            self.produced_in_minute += 1
        self._exit_before = at_exit

    def _run_slow_task(self) -> None:
        self._slow_due_ns = (self.now_ns // SLOW_NS + 1) * SLOW_NS
        self.slow_tasks += 1
        if self.slow_tasks % 600 == 0:
            self.produced_in_minute = 0
        if self.slow_tasks % 100 == 0:
            # Over the last minute, to the nearest ten.
            self._tens = [*self._tens[-6:], self.produced]
            per_s = (self._tens[-1] - self._tens[0]) / (10 * max(len(self._tens) - 1, 1))
            self.rate_per_hour = round(per_s * 360) * 10

    def _switch(self) -> tuple[bool, ...]:
        automatic, manual = self.automatic, self.modes.step == Mode.MANUAL
        screws = self.capping.screws
        if screws and not self.outputs[Output.SCREW]:
            self.torque = round(self._random.gauss(124, 9) / 10) * 10
        conveyor = automatic or (manual and self.inputs[Input.JOG])
        blinks = manual and self.now_ns // BLINK_NS % 2 == 0
        values = {
            Output.CONVEYOR: conveyor,
            Output.STOP_1: self.filling.lets_in,
            Output.STOP_2: self.filling.lets_go,
            Output.STOP_3: self.capping.lets_go,
            Output.TABLE: automatic and self.inputs[Input.GROUP_READY],
            Output.PUMP: automatic,
            Output.SHUTTER: self.filling.fills,
            Output.ARM_TO_PLACE: self.capping.to_place,
            Output.ARM_TO_PICK: self.capping.to_pick,
            Output.GRIPPER: self.capping.grips,
            Output.SCREW: screws,
            Output.GREEN: automatic or blinks,
            Output.ORANGE: not automatic,
            Output.LABELLING: automatic,
        }
        return tuple(values[output] for output in Output)
