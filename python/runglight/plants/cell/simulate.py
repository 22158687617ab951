"""One run of the cell from start to end: plant, program, logger and faults put together."""

from collections.abc import Sequence

from runglight.plants.agenda import NS_PER_S, nanoseconds
from runglight.plants.cell.controller import CellController
from runglight.plants.cell.faults import FAULTS
from runglight.plants.cell.feeding import PART_INTERVALS_S, PATTERN_LENGTH, PartFeed
from runglight.plants.cell.injector import TRIGGERS, FaultInjector
from runglight.plants.cell.labels import Showing
from runglight.plants.cell.plant import CellPlant
from runglight.plants.cell.symbols import INPUTS, OUTPUTS, SYMBOLS
from runglight.plants.faults import FaultDescription, FaultLabel, find_fault, label_of
from runglight.plants.logger import ChangeLogger
from runglight.plants.run import Columns, PlantRun
from runglight.plants.scan import ScanCycle

START_NS = 1_767_592_800 * NS_PER_S
"""2026-01-05T06:00:00Z, a Monday's early shift."""

DEFAULT_CYCLES = 20
DEFAULT_FAULT_CYCLE = 4
PART_PATTERN_FAULT = 6
FIRST_CYCLE_FAULTS = (PART_PATTERN_FAULT, 7)
NEXT_CYCLE_FAULT = 11
"""Begins at the end of its cycle and stops the next one."""

TAIL_S = 5.0
STOPPED_TAIL_S = 200.0

FaultChoice = int | str


def simulate_cell(
    cycles: int | None = None,
    seed: int = 1,
    fault: FaultChoice | Sequence[FaultChoice] | None = None,
    fault_cycle: int | None = None,
    start_ns: int = START_NS,
    *,
    part_intervals_s: Sequence[float] | None = None,
    skip_idle_scans: bool = True,
) -> PlantRun:
    """Runs the cell for `cycles` parts and returns its change log with the truth about its faults.

    `cycles` defaults to 20, with fault 6 to the 30 its pattern takes. `fault` is a number or name
    of `FAULTS`, or several. They begin in cycle `fault_cycle` (from 1; default 4, or the last one
    possible if that is earlier); fault 7 always begins in cycle 1 and fault 6 is there from the
    start. `part_intervals_s` (default 30, 60) is repeated for as many parts as there are: how
    long after the loader stands home and empty each part is set on it. A line that has stopped
    is watched for another 200 s. A fault that the line never lived to see has no label.

    Raises ValueError for a fault or cycle that does not exist.
    """
    faults = _chosen(fault)
    patterned = any(each.number == PART_PATTERN_FAULT for each in faults)
    if cycles is None:
        cycles = PATTERN_LENGTH if patterned else DEFAULT_CYCLES
    if cycles < 1:
        raise ValueError(f"a run has at least 1 cycle, not {cycles}")
    if patterned and part_intervals_s is not None:
        raise ValueError("fault 6 is a pattern of part intervals: give one or the other")
    if part_intervals_s is None:
        part_intervals_s = PART_INTERVALS_S
    if not part_intervals_s:
        raise ValueError("the pattern of part intervals is empty; give at least one, in seconds")
    plant = CellPlant(start_ns, seed, PartFeed(part_intervals_s, cycles))
    injectors = [
        FaultInjector(
            plant, each, TRIGGERS[each.number], cycle=_cycle_of(each, fault_cycle, cycles)
        )
        for each in faults
    ]
    number_of = {symbol: number for number, symbol in enumerate(SYMBOLS)}
    logger = ChangeLogger(
        [number_of[symbol] for symbol in INPUTS], [number_of[symbol] for symbol in OUTPUTS]
    )
    plant.power_on()
    ScanCycle(
        plant,
        CellController(),
        logger,
        start_ns=start_ns,
        outputs=(False,) * len(OUTPUTS),
        skip_idle_scans=skip_idle_scans,
    ).run_until_still()
    last_change_ns = start_ns if logger.last_change_ns is None else logger.last_change_ns
    end_ns = last_change_ns + nanoseconds(TAIL_S if plant.finished else STOPPED_TAIL_S)
    logger.close(end_ns)
    columns = logger.columns()
    return PlantRun(
        *columns,
        signals=tuple(symbol.name for symbol in SYMBOLS),
        labels=tuple(
            _label(each.fault, each.began_ns, columns)
            for each in injectors
            if each.began_ns is not None
        ),
        end_ns=end_ns,
    )


def _chosen(fault: FaultChoice | Sequence[FaultChoice] | None) -> tuple[FaultDescription, ...]:
    if fault is None:
        return ()
    choices = (fault,) if isinstance(fault, int | str) else tuple(fault)
    numbers = sorted({find_fault(FAULTS, choice).number for choice in choices})
    return tuple(FAULTS[number] for number in numbers)


def _cycle_of(fault: FaultDescription, fault_cycle: int | None, cycles: int) -> int:
    if fault.number in FIRST_CYCLE_FAULTS:
        return 1
    last = cycles - 1 if fault.number == NEXT_CYCLE_FAULT else cycles
    if last < 1:
        raise ValueError(f"fault {fault.number} {fault.name} needs a run of at least 2 cycles")
    if fault_cycle is None:
        return min(DEFAULT_FAULT_CYCLE, last)
    if not 1 <= fault_cycle <= last:
        raise ValueError(
            f"fault {fault.number} {fault.name} can begin in cycle 1 to {last} of a run of "
            f"{cycles} cycles, not in cycle {fault_cycle}"
        )
    return fault_cycle


def _label(fault: FaultDescription, began_ns: int, log: Columns) -> FaultLabel:
    if fault.last_state is not None:
        last_ns, end_ns = int(log.time_ns[-2]), int(log.time_ns[-1])
        return label_of(fault, began_ns, last_ns, (end_ns - last_ns) / NS_PER_S)
    showing = Showing(fault)
    for time_ns, number, value in zip(*(column.tolist() for column in log), strict=True):
        showing.row(time_ns, number, value, began_ns)
    return label_of(fault, began_ns, showing.shown_ns, showing.observed_s)
