"""The tank of Theis 2019: level, sensors, valves, and the programs of figures 2 and 3."""

import pytest

from runglight.plants.tank import SCENARIOS, RunningTank, simulate_tank
from runglight.plants.tank.flows import P1, P2
from runglight.plants.tank.ladder import LadderProgram
from runglight.plants.tank.mutations import chosen, mutations
from runglight.plants.tank.plant import TankPlant
from runglight.plants.tank.programs import C2

SECOND = 1_000_000_000
UL, LL, ML = 0, 1, 2
FILL = (True, False)
EMPTY = (False, True)


def test_an_open_valve_lets_nine_gallons_a_second_in() -> None:
    heard: list[tuple[int, int, bool]] = []
    tank = TankPlant(0, 1, P1, listener=lambda *change: heard.append(change))
    tank.write_outputs(FILL)
    tank.advance(10 * SECOND)
    # A valve takes a tenth of a second.
    assert tank.level == pytest.approx(9 * 9.9)
    assert [(sensor, feels) for _, sensor, feels in heard] == [(LL, True), (ML, True)]
    assert [time_ns / SECOND for time_ns, _, _ in heard] == pytest.approx(
        [0.1 + 10 / 9, 0.1 + 50 / 9]
    )
    tank.advance(20 * SECOND)
    assert (tank.level, tank.spilt) == (100.0, pytest.approx(9 * 19.9 - 100))


def test_the_level_is_the_same_however_often_one_looks() -> None:
    often, once = TankPlant(0, 3, P2), TankPlant(0, 3, P2)
    for tank in (often, once):
        tank.write_outputs(FILL)
    for tenth in range(1, 91):
        often.advance(tenth * SECOND // 10)
    once.advance(9 * SECOND)
    assert often.level == pytest.approx(once.level)
    assert once.level != pytest.approx(9 * 8.9)


def test_closed_valves_leak_in_the_second_plant_alone() -> None:
    for flows, moves in ((P1, False), (P2, True)):
        tank = TankPlant(0, 1, flows, level=50.5)
        tank.advance(600 * SECOND)
        assert (tank.level != 50.5) is moves


def _activities(run: object) -> list[str]:
    """`LL=0` and so on; what changes in one scan, inputs and outputs apart, is one word."""
    words: list[str] = []
    last = None
    for time_ns, number, value in zip(run.time_ns, run.signal_index, run.value, strict=True):
        name = f"{run.signals[number]}={value}"
        if number >= 3 and last == (time_ns, True):
            words[-1] += f" & {name}"
        else:
            words.append(name)
        last = (time_ns, number >= 3)
    return words


def _traces(scenario: str, seed: int = 1) -> list[tuple[str, ...]]:
    """Whole traces: from one reset to the next (Theis 2019, Algorithm 1)."""
    traces: list[list[str]] = [[]]
    for word in _activities(simulate_tank(scenario, seed))[:-1]:
        if word == "%IX0.1=0":
            traces.append([])
        traces[-1].append(word)
    return [tuple(trace) for trace in traces[1:-1]]


def test_the_scenarios_give_about_as_many_traces_as_in_the_paper() -> None:
    # 48, 22 and 22 there; these are whole traces, without the incomplete first and last one.
    assert {name: len(_traces(name)) for name in SCENARIOS} == {"1": 47, "2": 22, "3": 21}


def test_every_trace_of_a_program_is_the_same() -> None:
    for scenario, swings in (("1", 1), ("2", 3), ("3", 3)):
        (trace,) = set(_traces(scenario))
        fill, empty = "%QX0.0=1 & %QX0.1=0", "%QX0.0=0 & %QX0.1=1"
        swing = ("%IX0.0=1", empty, "%IX0.0=0", "%IX0.2=0")
        first = ("%IX0.1=0", fill, "%IX0.1=1", "%IX0.2=1", *swing)
        assert trace == first + (fill, "%IX0.2=1", *swing) * (swings - 1)


def test_a_served_tank_obeys_whoever_writes() -> None:
    tank = RunningTank(0)
    heard: list[tuple[int, int, int]] = []
    tank.on_change(lambda *change: heard.append(change))
    tank.advance(SECOND)
    tank.write(0, 1)
    tank.write(0, 1)
    tank.advance(3 * SECOND)
    assert heard == [(SECOND, 3, 1), (SECOND + 100_000_000 + 10 * SECOND // 9, LL, 1)]
    assert tank.image() == ((0, 1, 0), (1, 0), ())


def test_a_broken_sensor_and_a_broken_valve() -> None:
    tank = RunningTank(0)
    tank.inject("ul-dead", 5 * SECOND)
    tank.inject("inv-dead", 20 * SECOND)
    with pytest.raises(ValueError, match="is there already"):
        tank.inject(1)
    tank.write(0, 1)
    tank.advance(15 * SECOND)
    assert tank.image().inputs == (0, 1, 1)
    assert [label.name for label in tank.labels()] == ["ul-dead"]
    tank.write(0, 0)
    tank.write(1, 1)
    tank.advance(25 * SECOND)
    level = tank.plant.level
    tank.write(1, 0)
    tank.write(0, 1)
    tank.advance(30 * SECOND)
    assert tank.plant.level == pytest.approx(level - 0.9)


def test_a_counter_counts_rising_edges_and_resets() -> None:
    program = LadderProgram(C2)
    # Full for the third time, it empties below the middle.
    outputs = []
    for ul, ll, ml in [(0, 0, 0), *[(1, 1, 1), (0, 1, 1), (0, 1, 0)] * 3, (0, 0, 0)]:
        outputs.append(program.scan([bool(ul), bool(ll), bool(ml)], 0))
    assert outputs[0] == FILL
    assert [outputs[place] for place in (3, 6, 9)] == [FILL, FILL, EMPTY]
    assert outputs[10] == FILL


def test_mutations_are_one_error_away_and_seeded() -> None:
    all_of_them = mutations(C2)
    assert len({mutation.sentence for mutation in all_of_them}) > 40
    assert all(mutation.ladder != C2 for mutation in all_of_them)
    assert chosen(all_of_them, 5, 1) == chosen(all_of_them, 5, 1) != chosen(all_of_them, 5, 2)
    assert any("preset 4" in mutation.sentence for mutation in all_of_them)


def test_there_is_no_fourth_scenario() -> None:
    with pytest.raises(ValueError, match="there is no scenario '4'"):
        simulate_tank("4")
