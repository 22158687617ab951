"""The cell at work without an end: its rows are those of `simulate_cell`, and faults show."""

from itertools import pairwise

import pytest

from runglight.plants import PLANTS, Image
from runglight.plants.cell import RunningCell, simulate_cell

S = 1_000_000_000
START_NS = 1_767_592_800 * S
Row = tuple[int, int, int]


def started(seed: int = 1) -> tuple[RunningCell, list[Row]]:
    cell, rows = RunningCell(START_NS, seed), []
    cell.on_change(lambda *row: rows.append(row))
    return cell, rows


def rows_of_run(seed: int, cycles: int) -> tuple[list[Row], int]:
    """Rows of a simulated run up to its last part, and the time until which they are complete."""
    run = simulate_cell(cycles, seed=seed)
    rows = list(
        zip(run.time_ns.tolist(), run.signal_index.tolist(), run.value.tolist(), strict=True)
    )
    last_part_ns = next(
        time_ns
        for time_ns, number, value in reversed(rows)
        if run.signals[number] == "Group1-PrtLDR-PRT_CHK" and value
    )
    return [row for row in rows if row[0] <= last_part_ns], last_part_ns


@pytest.mark.parametrize("seed", [1, 2, 3, 11])
@pytest.mark.parametrize("step_ns", [10_000_000, 7_777_777, 60 * S])
def test_it_shows_the_changes_of_the_simulated_run(seed: int, step_ns: int) -> None:
    expected, until_ns = rows_of_run(seed, cycles=4)
    cell, rows = started(seed)
    for now_ns in range(START_NS, until_ns, step_ns):
        cell.advance(now_ns)
    cell.advance(until_ns)
    assert len(expected) > 150
    assert rows == expected


def test_the_image_is_what_the_rows_say_at_every_scan() -> None:
    cell, rows = started()
    values = [0] * len(cell.symbols)
    for scan in range(20_000):
        cell.advance(START_NS + scan * 10_000_000)
        for _, number, value in rows:
            values[number] = value
        rows.clear()
        by_class = {
            name: tuple(
                value
                for symbol, value in zip(cell.symbols, values, strict=True)
                if symbol.signal_class == name
            )
            for name in ("input", "output")
        }
        assert cell.image() == Image(by_class["input"], by_class["output"])
    assert cell.cycles == 3


def test_time_that_has_passed_changes_nothing() -> None:
    cell, rows = started()
    cell.advance(START_NS - 1)
    assert (rows, cell.image()) == ([], Image())
    cell.advance(START_NS + 60 * S)
    seen, image = len(rows), cell.image()
    cell.advance(START_NS + 10 * S)
    assert (len(rows), cell.image()) == (seen, image)


SHOWN_BEFORE_S = 180


@pytest.mark.parametrize("at_s", [0, 400, 431.234567891])
@pytest.mark.parametrize("number", range(1, 13))
def test_every_fault_begins_and_shows_soon_after_it_was_asked_for(number: int, at_s: float) -> None:
    broken, rows = started(seed=5)
    whole, sound_rows = started(seed=5)
    at_ns = START_NS + round(at_s * S)
    fault = broken.inject(number, at_ns)
    assert broken.waiting() == (fault,)
    for cell in (broken, whole):
        cell.advance(at_ns + 10 * SHOWN_BEFORE_S * S)
    (label,) = broken.labels()
    assert at_ns <= label.time_ns < at_ns + SHOWN_BEFORE_S * S
    before = [row for row in sound_rows if row[0] < label.time_ns]
    assert rows[: len(before)] == before
    assert rows != sound_rows
    assert broken.waiting() == ()
    if number == 6:
        assert label.shown_ns is None
        return
    assert label.shown_ns is not None
    assert label.time_ns <= label.shown_ns < label.time_ns + SHOWN_BEFORE_S * S
    symbols = broken.symbols
    states = [
        (time_ns, symbols[row].device, f"{symbols[row].name}_{'ON' if value else 'OFF'}")
        for time_ns, row, value in rows
    ]
    if label.last_state is not None:
        assert states[-1] == (label.shown_ns, label.device, label.last_state)
        assert label.observed_s == (broken.now_ns - label.shown_ns) / S
        return
    chain = [(time_ns, state) for time_ns, device, state in states if device == label.device]
    shown = [
        (after_ns, (after_ns - before_ns) / S)
        for (before_ns, before_state), (after_ns, after_state) in pairwise(chain)
        if (before_state, after_state) == label.faulty and after_ns >= label.time_ns
    ]
    assert shown[0] == (label.shown_ns, label.observed_s)


@pytest.mark.parametrize("number", [1, 2, 4, 7, 8, 10])
def test_at_work_an_unknown_transition_is_one_that_sound_work_never_shows(number: int) -> None:
    cell, rows = started(seed=2)
    cell.advance(START_NS + 3600 * S)
    sound = len(rows)
    cell.inject(number)
    cell.advance(START_NS + 3600 * S + 2 * SHOWN_BEFORE_S * S)
    (label,) = cell.labels()
    chain = [
        (position, f"{cell.symbols[row].name}_{'ON' if value else 'OFF'}")
        for position, (_, row, value) in enumerate(rows)
        if cell.symbols[row].device == label.device
    ]
    known = {(a, b) for (_, a), (after, b) in pairwise(chain) if after < sound}
    assert label.faulty not in known
    assert set(label.expected) <= known


def test_faults_that_pass_are_over_and_can_come_again() -> None:
    cell, _ = started()
    cell.inject("open-decelerated")
    with pytest.raises(ValueError, match="3 open-decelerated is there already"):
        cell.inject(3)
    cell.advance(START_NS + 600 * S)
    assert (cell.waiting(), cell.acting()) == ((), ())
    again = cell.inject(3)
    cell.advance(START_NS + 1200 * S)
    assert [label.number for label in cell.labels()] == [3, 3]
    cell.inject(2)
    cell.advance(START_NS + 1800 * S)
    assert [fault.number for fault in cell.acting()] == [2]
    assert again.number == 3


def test_a_fault_asked_for_in_the_past_begins_now_even_where_the_line_stands() -> None:
    cell, rows = started()
    cell.inject(5)
    cell.advance(START_NS + 3600 * S)
    stopped = len(rows)
    assert rows[-1][0] < START_NS + 300 * S
    cell.inject(7, at_ns=START_NS)
    cell.advance(START_NS + 7200 * S)
    assert len(rows) == stopped
    assert [fault.number for fault in cell.waiting()] == [7]


def test_what_the_plant_has_not_is_refused() -> None:
    with pytest.raises(ValueError, match="no fault 13"):
        started()[0].inject(13)


def test_the_registry_runs_the_cell_and_no_body_shop() -> None:
    assert PLANTS["bodyshop"].run is None
    run = PLANTS["cell"].run
    assert run is not None
    cell = run(START_NS, 3)
    cell.advance(START_NS)
    assert sum(cell.image().inputs) == 6
    assert cell.symbols == PLANTS["cell"].symbols
    assert cell.faults == PLANTS["cell"].faults
