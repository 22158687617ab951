"""One run of the press from start to end, as a log."""

from collections.abc import Callable, Sequence

from runglight.plants.agenda import NS_PER_S, nanoseconds
from runglight.plants.faults import find_fault
from runglight.plants.image_log import ImageLog
from runglight.plants.press.faults import FAULTS
from runglight.plants.press.running import RunningPress
from runglight.plants.press.symbols import SYMBOLS
from runglight.plants.run import PlantRun

START_NS = 1_767_592_800 * NS_PER_S
"""2026-01-05T06:00:00Z, a Monday's early shift."""

DEFAULT_CYCLES = 50
DEFAULT_FAULT_CYCLE = 4
FAULT_EVERY = 3
"""Cycles from one failure to the next where several are asked for."""

SLICE_NS = nanoseconds(20.0)
TAIL_CYCLES = 2

FaultChoice = int | str
Script = Callable[[RunningPress], None]


def simulate_press(
    cycles: int | None = None,
    seed: int = 1,
    fault: FaultChoice | Sequence[FaultChoice] | None = None,
    fault_cycle: int | None = None,
    start_ns: int = START_NS,
) -> PlantRun:
    """Runs the press for `cycles` parts and returns its change log with the truth about its faults.

    `fault` is a number or name of `FAULTS`, or several: the first breaks in cycle `fault_cycle`
    (from 1; default 4), each further one three cycles later. An operator mends it some minutes
    after the alarm, and the press goes on.

    Raises ValueError for a fault or cycle that does not exist.
    """
    choices: Sequence[FaultChoice] = (
        () if fault is None else (fault,) if isinstance(fault, int | str) else fault
    )
    faults = [find_fault(FAULTS, choice) for choice in choices]
    first = DEFAULT_FAULT_CYCLE if fault_cycle is None else fault_cycle
    needed = first + FAULT_EVERY * len(faults) + TAIL_CYCLES if faults else 1
    if cycles is None:
        cycles = max(DEFAULT_CYCLES, needed)
    if cycles < 1:
        raise ValueError(f"a run has at least 1 cycle, not {cycles}")
    if first < 1 or (faults and cycles < first):
        raise ValueError(f"a fault can begin in cycle 1 to {cycles}, not in cycle {first}")
    press = RunningPress(start_ns, seed)
    log = ImageLog(press, start_ns)
    queue = [(first + FAULT_EVERY * place, fault.number) for place, fault in enumerate(faults)]
    now_ns = start_ns
    while press.cycles < cycles:
        while queue and press.cycles + 1 >= queue[0][0]:
            press.inject(queue.pop(0)[1])
        now_ns += SLICE_NS
        press.advance(now_ns)
    return log.run(now_ns, [symbol.name for symbol in SYMBOLS])
