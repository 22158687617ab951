"""The scan cycle: reads the inputs, lets the logger look, runs the program, writes the outputs.

The clock is simulated and exact: scans lie on a grid of `scan_interval_ns`. Scans in which
provably nothing can change are not run; the log is the same as if they had been.
"""

from collections.abc import Callable, Sequence
from typing import Generic, Protocol, TypeVar

Value = TypeVar("Value", bound=int)
"""What a signal holds: bool where a PLC has bits only, int where it has words too."""

SCAN_INTERVAL_NS = 10_000_000


class Plant(Protocol[Value]):
    """The physical side: it moves with time, reports its sensors and follows its outputs."""

    def advance(self, now_ns: int) -> None:
        """Lets the machine move on to `now_ns`."""

    def read_inputs(self) -> tuple[Value, ...]:
        """What the sensors report now."""

    def write_outputs(self, outputs: Sequence[Value]) -> None:
        """Switches the actuators now."""

    def next_event_ns(self) -> int | None:
        """When the machine next changes by itself; None while nothing moves or will move."""


class Controller(Protocol[Value]):
    """The PLC program: sees the input image and the time, writes the output image."""

    def scan(self, inputs: Sequence[Value], now_ns: int) -> tuple[Value, ...]:
        """Runs the program once."""

    @property
    def settled(self) -> bool:
        """Whether the last scan left the program's memory as it was."""

    def next_timer_ns(self) -> int | None:
        """When the next running timer ends; None if none runs."""


class Sampler(Protocol):
    """Whoever looks at the PLC's images once in every scan."""

    def sample(
        self,
        time_ns: int,
        inputs: tuple[int, ...],
        outputs: tuple[int, ...],
        memory: tuple[int, ...] = (),
    ) -> None:
        """Looks at the images."""


def no_memory() -> tuple[int, ...]:
    """The memory of a program that shows none."""
    return ()


class ScanCycle(Generic[Value]):
    """A PLC at work on a plant, scan after scan.

    An output set in one scan is seen by the sampler in the next, so a change is seen at least one
    scan after the sensor that caused it; so is the program's `memory`. `skip_idle_scans=False`
    runs every scan (slow).
    """

    def __init__(
        self,
        plant: Plant[Value],
        controller: Controller[Value],
        sampler: Sampler,
        *,
        start_ns: int,
        outputs: tuple[Value, ...],
        memory: Callable[[], tuple[int, ...]] = no_memory,
        scan_interval_ns: int = SCAN_INTERVAL_NS,
        skip_idle_scans: bool = True,
    ) -> None:
        self._plant = plant
        self._controller = controller
        self._sampler = sampler
        self._outputs = outputs
        self._memory = memory
        self._interval_ns = scan_interval_ns
        self._skip_idle_scans = skip_idle_scans
        self._scanned_ns = start_ns - scan_interval_ns
        self._busy = True

    def next_scan_ns(self) -> int | None:
        """Time of the next scan that can change anything; None while everything stands still.

        Worked out anew at every call: somebody may have broken the plant since the last scan.
        """
        if self._busy:
            return self._scanned_ns + self._interval_ns
        due_ns = _earliest(self._plant.next_event_ns(), self._controller.next_timer_ns())
        if due_ns is None:
            return None
        scans = -((self._scanned_ns - due_ns) // self._interval_ns) if self._skip_idle_scans else 1
        return self._scanned_ns + max(scans, 1) * self._interval_ns

    def scan(self, now_ns: int) -> None:
        """Runs one scan at a time that `next_scan_ns` named."""
        self._plant.advance(now_ns)
        inputs = self._plant.read_inputs()
        self._sampler.sample(now_ns, inputs, self._outputs, self._memory())
        outputs = self._controller.scan(inputs, now_ns)
        switched = outputs != self._outputs
        if switched:
            self._plant.write_outputs(outputs)
        self._outputs = outputs
        self._scanned_ns = now_ns
        self._busy = switched or not self._controller.settled

    def advance(self, now_ns: int) -> None:
        """Runs every scan that is due by `now_ns`."""
        while (due_ns := self.next_scan_ns()) is not None and due_ns <= now_ns:
            self.scan(due_ns)

    def run_until_still(self) -> None:
        """Runs until nothing can change any more: the work is done, or the line waits."""
        while (due_ns := self.next_scan_ns()) is not None:
            self.scan(due_ns)


def _earliest(first_ns: int | None, second_ns: int | None) -> int | None:
    if first_ns is None or second_ns is None:
        return second_ns if first_ns is None else first_ns
    return min(first_ns, second_ns)
