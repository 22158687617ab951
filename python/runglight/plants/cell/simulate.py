"""One run of the cell from start to end: plant, program, logger and faults put together."""

from collections.abc import Sequence
from itertools import cycle as repeat
from itertools import islice

from runglight.plants.agenda import NS_PER_S, nanoseconds
from runglight.plants.cell.controller import CellController
from runglight.plants.cell.faults import (
    DEFAULT_FAULT_CYCLE,
    FAULTS,
    PATTERN_LENGTH,
    FaultInjector,
    mostly_60_s_pattern,
)
from runglight.plants.cell.plant import CellPlant
from runglight.plants.cell.symbols import INPUTS, OUTPUTS, SYMBOLS
from runglight.plants.faults import FaultDescription, FaultKind, FaultLabel, find_fault
from runglight.plants.logger import ChangeLogger
from runglight.plants.run import Columns, PlantRun
from runglight.plants.scan import run_until_still

START_NS = 1_767_592_800 * NS_PER_S
"""2026-01-05T06:00:00Z, a Monday's early shift."""

DEFAULT_CYCLES = 20
PART_INTERVALS_S = (30.0, 60.0)
PART_PATTERN_FAULT = 6
FIRST_CYCLE_FAULT = 7
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
    is watched for another 200 s.

    Raises ValueError for a fault or cycle that does not exist.
    """
    faults = _chosen(fault)
    patterned = any(each.number == PART_PATTERN_FAULT for each in faults)
    if cycles is None:
        cycles = PATTERN_LENGTH if patterned else DEFAULT_CYCLES
    if cycles < 1:
        raise ValueError(f"a run has at least 1 cycle, not {cycles}")
    if part_intervals_s is None:
        part_intervals_s = mostly_60_s_pattern() if patterned else PART_INTERVALS_S
    plant = CellPlant(start_ns, seed, tuple(islice(repeat(part_intervals_s), cycles)))
    injectors = [
        FaultInjector(plant, each, _cycle_of(each, fault_cycle, cycles))
        for each in faults
        if each.number != PART_PATTERN_FAULT
    ]
    number_of = {symbol: number for number, symbol in enumerate(SYMBOLS)}
    logger = ChangeLogger(
        [number_of[symbol] for symbol in INPUTS], [number_of[symbol] for symbol in OUTPUTS]
    )
    plant.power_on()
    run_until_still(
        plant,
        CellController(),
        logger,
        start_ns=start_ns,
        outputs=(False,) * len(OUTPUTS),
        skip_idle_scans=skip_idle_scans,
    )
    last_change_ns = start_ns if logger.last_change_ns is None else logger.last_change_ns
    end_ns = last_change_ns + nanoseconds(TAIL_S if plant.finished else STOPPED_TAIL_S)
    logger.close(end_ns)
    columns = logger.columns()
    began_ns = {each.fault.number: each.began_ns for each in injectors}
    began_ns[PART_PATTERN_FAULT] = start_ns
    return PlantRun(
        *columns,
        signals=tuple(symbol.name for symbol in SYMBOLS),
        labels=tuple(
            _label(each, time_ns, columns)
            for each in faults
            if (time_ns := began_ns[each.number]) is not None
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
    if fault.number == FIRST_CYCLE_FAULT:
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


def _label(fault: FaultDescription, time_ns: int, log: Columns) -> FaultLabel:
    shown_ns, observed_s = _shown(fault, time_ns, log)
    return FaultLabel(
        number=fault.number,
        name=fault.name,
        time_ns=time_ns,
        group=fault.group,
        device=fault.device,
        signal=fault.signal,
        kind=fault.kind,
        description=fault.sentence,
        faulty=fault.faulty,
        expected=fault.expected,
        expected_s=fault.expected_s,
        last_state=fault.last_state,
        shown_ns=shown_ns,
        observed_s=observed_s,
    )


def _shown(
    fault: FaultDescription, time_ns: int, log: Columns
) -> tuple[int, float] | tuple[None, None]:
    """Where the log first shows the fault, and the seconds its transition or silence took."""
    if fault.kind is FaultKind.PART_PATTERN:
        return None, None
    if fault.faulty is None:
        last_ns, end_ns = int(log.time_ns[-2]), int(log.time_ns[-1])
        return last_ns, (end_ns - last_ns) / NS_PER_S
    before: tuple[str, int] | None = None
    for row_ns, number, value in zip(*(column.tolist() for column in log), strict=True):
        symbol = SYMBOLS[number]
        if symbol.device != fault.device:
            continue
        state = f"{symbol.name}_{'ON' if value else 'OFF'}"
        if before is not None and row_ns >= time_ns and (before[0], state) == fault.faulty:
            return row_ns, (row_ns - before[1]) / NS_PER_S
        before = state, row_ns
    return None, None
