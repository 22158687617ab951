"""The learned controller at a tank, over real Modbus TCP, in virtual time.

Long runs are `benches/tank.py`; here each is long enough for two to three runs of the tank.
"""

import json
from pathlib import Path

import pytest

from benches.tank_loop import Outcome, at_the_tank
from runglight._engine import Controller, PetriNet, Shadow, event_log, train_next
from runglight.control.guards import learn_guards, said
from runglight.log.changelog import Log
from runglight.plants.tank import simulate_tank
from runglight.plants.tank.flows import P1, P2
from runglight.plants.tank.ladder import LadderProgram
from runglight.plants.tank.mutations import mutations
from runglight.plants.tank.programs import C1, C2
from tests.control.nets import FIGURE_5, FIGURE_7, net

SECONDS = 100.0


@pytest.fixture
def figure_5(tmp_path: Path) -> PetriNet:
    """Fills and empties."""
    return net(tmp_path, FIGURE_5, "p8")


@pytest.fixture
def figure_7(tmp_path: Path) -> PetriNet:
    """Swings."""
    return net(tmp_path, FIGURE_7, "p9")


def _log(scenario: str) -> Log:
    run = simulate_tank(scenario)
    return Log.from_columns(run.time_ns, run.signal_index, run.value, run.signals)


def _guards(net_: PetriNet, scenario: str) -> str:
    return learn_guards(net_, [_log(scenario)]).text


def _inside(outcome: Outcome) -> bool:
    return outcome.lowest >= 0 and outcome.highest < 95 and not outcome.spilt


def test_it_takes_the_place_of_the_first_program(figure_5: PetriNet) -> None:
    original = at_the_tank(C1, P1, SECONDS)
    learned = at_the_tank(Controller(figure_5), P1, SECONDS)
    assert learned.findings == []
    assert learned.activities[1:] == original.activities[1:]
    assert len(learned.traces) >= 3
    assert _inside(learned)


def test_it_takes_the_place_of_the_counting_program(figure_7: PetriNet) -> None:
    guards = _guards(figure_7, "2")
    original = at_the_tank(C2, P1, SECONDS)
    learned = at_the_tank(Controller(figure_7, guards), P1, SECONDS)
    assert learned.findings == []
    assert learned.activities[1:] == original.activities[1:]
    uncertain = at_the_tank(Controller(figure_7, _guards(figure_7, "3")), P2, SECONDS)
    assert uncertain.findings == []
    assert set(uncertain.traces) == set(original.traces)
    assert _inside(uncertain)


def test_a_network_decides_where_no_guards_do(figure_7: PetriNet) -> None:
    runs = event_log(_log("2").engine, "%IX0.1=0")
    settings = json.dumps({"epochs": 200, "seed": 1})
    network = train_next(runs, figure_7, list(range(17)), settings, [], "{}")
    original = at_the_tank(C2, P1, SECONDS)
    learned = at_the_tank(Controller(figure_7, None, network), P1, SECONDS)
    assert learned.findings == []
    assert learned.activities[1:] == original.activities[1:]


def test_what_was_learned_is_told_in_words(figure_7: PetriNet) -> None:
    learned = learn_guards(figure_7, [_log("2")])
    labels = {row[0]: row[1] or row[0] for row in figure_7.transitions()}
    assert [said(point["choice"], labels) for point in learned.decisions] == [
        "set %QX0.0=1 & %QX0.1=0; once %IX0.2=0 has come 3 times in this run, wait"
    ]
    assert (learned.runs, learned.departures) == (23, 0)


def test_the_skipped_scans_change_nothing(figure_7: PetriNet) -> None:
    guards = _guards(figure_7, "3")
    sparse, dense = (
        at_the_tank(Controller(figure_7, guards), P2, 45.0, sparse=sparse)
        for sparse in (True, False)
    )
    assert sparse.changes == dense.changes
    assert sparse.scans < dense.scans


def test_a_shadow_agrees_with_the_intact_program_and_names_a_wrong_preset(
    figure_7: PetriNet,
) -> None:
    guards = _guards(figure_7, "2")
    assert at_the_tank(C2, P1, SECONDS, shadow=Shadow(figure_7, guards)).findings == []
    (fewer,) = [each for each in mutations(C2) if "preset 2" in each.sentence]
    found = at_the_tank(fewer.ladder, P1, 80.0, shadow=Shadow(figure_7, guards)).findings
    assert (found[0]["kind"], found[0]["model"]) == ("late", "process")
    assert "%QX0.0=1 & %QX0.1=0 did not come" in found[0]["message"]


def test_a_dead_sensor_ends_in_the_safe_state(figure_5: PetriNet) -> None:
    controller = Controller(figure_5, _guards(figure_5, "1"), None, [("%QX0.1", 1)])
    outcome = at_the_tank(controller, P1, 120.0, fault="ul-dead")
    (finding,) = outcome.findings
    assert (finding["kind"], finding["severity"]) == ("late", "fault")
    assert "safe state: %QX0.0=0, %QX0.1=1" in finding["message"]
    assert controller.mode == "safe"
    written = [each for each in outcome.activities if each.startswith("%Q")]
    assert written[-1] == "%QX0.0=0 & %QX0.1=1"


def test_it_goes_on_where_another_controller_stopped(figure_5: PetriNet) -> None:
    controller = Controller(figure_5)
    program = LadderProgram(C1)
    outputs = program.scan([False, False, False], 0)
    assert outputs == (True, False)
    # Half full and filling, as the program left it.
    assert controller.scan(0, [0, 1, 1, 1, 0])[0] == []
    assert controller.last == "%IX0.2=1"
    assert controller.scan(1, [1, 1, 1, 1, 0])[0] == [(3, 0), (4, 1)]
