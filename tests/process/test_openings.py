"""Where runs begin: the machine's own beginning is found, and nonsense is not."""

from pathlib import Path

import numpy as np
import pytest

import runglight as rl
from runglight.errors import InputError
from runglight.process.openings import openings
from tests.process.counting_tank import changes, log_of


def test_the_tank_begins_where_it_is_empty() -> None:
    found, events = openings(log_of(changes(12)))
    best = found[0]
    assert best.change == "%IX0.1=0"
    assert (best.runs, best.same_activities, best.same_order) == (12, 1.0, 1.0)
    cut = rl.event_log(log_of(changes(12)), reset=best.change)
    assert best.events == len(cut.sequences()[0])
    assert best.runs == cut.traces
    # Within a run it swings: cut there, runs are of two kinds.
    swings = next(each for each in found if each.change == "%IX0.2=0")
    assert swings.runs > 2 * best.runs
    assert 0.5 < swings.same_activities < 0.8
    assert len(events) > len(cut)


def test_the_cell_begins_with_its_part(cell: Path) -> None:
    found, _ = openings(rl.read_log(cell / "nominal.csv"), symbols=cell / "symbols.csv")
    assert found[0].change == "Group1-PrtLDR-PRT_CHK=1"
    assert found[0].signal_class == "input"
    assert found[0].same_order == 1.0


def test_shares_are_those_of_the_runs_themselves(cell: Path) -> None:
    log = rl.read_log(cell / "faulty.csv")
    found, _ = openings(log)
    looked = 0
    for each in found[::7]:
        runs = [tuple(run) for run in rl.event_log(log, reset=each.change).sequences()]
        assert each.runs == len(runs)
        commonest = max(runs.count(run) for run in set(runs))
        assert each.same_order == pytest.approx(commonest / len(runs))
        bags = [tuple(sorted(run)) for run in runs]
        assert each.same_activities == pytest.approx(
            max(bags.count(bag) for bag in set(bags)) / len(bags)
        )
        looked += 1
    assert looked > 3


def test_only_some_signals() -> None:
    found, _ = openings(log_of(changes(6)), only=["%IX0.0", "%IX0.2"])
    assert {each.change[:6] for each in found} == {"%IX0.0", "%IX0.2"}


def test_a_log_in_which_nothing_happens() -> None:
    still = rl.Log.from_columns(
        np.array([0, 1], np.int64),
        np.array([0, 1], np.uint32),
        np.array([0, 1], np.int64),
        ["a", "b"],
    )
    with pytest.raises(InputError, match="nothing changes"):
        openings(still)
