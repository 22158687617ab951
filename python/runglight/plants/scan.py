"""The scan cycle: reads the inputs, lets the logger look, runs the program, writes the outputs.

The clock is simulated and exact: scans lie on a grid of `scan_interval_ns`. Scans in which
provably nothing can change are not run; the log is the same as if they had been.
"""

from collections.abc import Sequence
from typing import Protocol

from runglight.plants.logger import ChangeLogger

SCAN_INTERVAL_NS = 10_000_000


class Plant(Protocol):
    """The physical side: it moves with time, reports its sensors and follows its outputs."""

    def advance(self, now_ns: int) -> None:
        """Lets the machine move on to `now_ns`."""

    def read_inputs(self) -> tuple[bool, ...]:
        """What the sensors report now."""

    def write_outputs(self, outputs: Sequence[bool]) -> None:
        """Switches the actuators now."""

    def next_event_ns(self) -> int | None:
        """When the machine next changes by itself; None while nothing moves or will move."""


class Controller(Protocol):
    """The PLC program: sees the input image and the time, writes the output image."""

    def scan(self, inputs: Sequence[bool], now_ns: int) -> tuple[bool, ...]:
        """Runs the program once."""

    @property
    def settled(self) -> bool:
        """Whether the last scan left the program's memory as it was."""

    def next_timer_ns(self) -> int | None:
        """When the next running timer ends; None if none runs."""


def run_until_still(
    plant: Plant,
    controller: Controller,
    logger: ChangeLogger,
    *,
    start_ns: int,
    outputs: tuple[bool, ...],
    scan_interval_ns: int = SCAN_INTERVAL_NS,
    skip_idle_scans: bool = True,
) -> None:
    """Runs scan after scan until nothing can change any more: the work is done, or the line waits.

    An output set in one scan is seen by the logger in the next, so a change is logged at least
    one scan after the sensor that caused it. `skip_idle_scans=False` runs every scan (slow).
    """
    now_ns = start_ns
    while True:
        plant.advance(now_ns)
        inputs = plant.read_inputs()
        logger.sample(now_ns, inputs, outputs)
        previous, outputs = outputs, controller.scan(inputs, now_ns)
        if outputs != previous:
            plant.write_outputs(outputs)
        if outputs == previous and controller.settled:
            due_ns = _earliest(plant.next_event_ns(), controller.next_timer_ns())
            if due_ns is None:
                return
            if skip_idle_scans:
                idle_scans = -((now_ns - due_ns) // scan_interval_ns) - 1
                now_ns += max(idle_scans, 0) * scan_interval_ns
        now_ns += scan_interval_ns


def _earliest(first_ns: int | None, second_ns: int | None) -> int | None:
    if first_ns is None or second_ns is None:
        return second_ns if first_ns is None else first_ns
    return min(first_ns, second_ns)
