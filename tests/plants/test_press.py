"""The press: the signals of the paper's machine, and each failure shows at its address."""

import pytest

from runglight.plants import PLANTS
from runglight.plants.press import FAILURES, FAULTS, INPUTS, MODES, SYMBOLS, RunningPress
from runglight.plants.press.simulate import SLICE_NS, START_NS, simulate_press

DAY_NS = 86_400 * 10**9


def run(press: RunningPress, cycles: int) -> None:
    now_ns = press.now_ns
    while press.cycles < cycles:
        now_ns += SLICE_NS
        press.advance(now_ns)
        assert now_ns < START_NS + DAY_NS, "the press has stopped for good"


def test_signals_are_those_of_the_paper() -> None:
    assert len(INPUTS) == 27 * 8
    assert [symbol.address for symbol in INPUTS] == [
        f"I{byte}.{bit}" for byte in range(27) for bit in range(8)
    ]
    addresses = [symbol.address for symbol in SYMBOLS]
    assert len(set(addresses)) == len(addresses)
    assert len({symbol.name for symbol in SYMBOLS}) == len(SYMBOLS)
    named = [MODES["work_complete"], *MODES["manual"], *MODES["alarm"]]
    assert set(named) <= set(addresses)


def test_a_sound_press_never_alarms() -> None:
    press = RunningPress(START_NS, seed=5)
    run(press, 25)
    assert press.alarms == ()
    assert press.labels() == ()


def test_the_same_seed_gives_the_same_log() -> None:
    first, second = simulate_press(3, seed=9), simulate_press(3, seed=9)
    assert first.time_ns.tolist() == second.time_ns.tolist()
    assert first.signal_index.tolist() == second.signal_index.tolist()
    assert simulate_press(3, seed=10).time_ns.tolist() != first.time_ns.tolist()


def test_a_log_begins_with_the_whole_image() -> None:
    log = simulate_press(1)
    first = log.signal_index[log.time_ns == START_NS]
    assert sorted(first.tolist()) == list(range(len(SYMBOLS)))


@pytest.mark.parametrize("number", list(FAULTS))
def test_every_failure_alarms_at_its_address_and_is_mended(number: int) -> None:
    press = RunningPress(START_NS, seed=3)
    run(press, 1)
    press.inject(number)
    run(press, 4)
    assert press.waiting() == ()
    [label] = press.labels()
    assert label.shown_ns is not None
    assert press.alarms, FAULTS[number].name
    assert press.alarms[0][1] in FAILURES[number].shows
    assert press.acting() == ()


def test_stops_and_variations_are_no_alarms() -> None:
    press = RunningPress(START_NS, seed=4)
    run(press, 1)
    for bring_on in (
        press.intervene,
        lambda: press.stop_at_end_of_cycle(300.0),
        lambda: press.starve(300.0),
        lambda: press.vary("Clamp2"),
        lambda: press.bounce("Drill1"),
    ):
        bring_on()
        run(press, press.cycles + 3)
    assert press.alarms == ()


def test_a_fault_waits_for_its_end_before_it_may_come_again() -> None:
    press = RunningPress(START_NS)
    press.inject("clamp2-adv-dead")
    with pytest.raises(ValueError, match="is there already"):
        press.inject(1)
    with pytest.raises(ValueError, match="has no fault"):
        press.inject("earthquake")


def test_it_is_listed() -> None:
    assert PLANTS["press"].run is RunningPress
    with pytest.raises(ValueError, match="at least 1 cycle"):
        simulate_press(0)
