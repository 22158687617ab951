"""The press: the signals of the paper's machine, and each failure shows at its address."""

from collections.abc import Callable

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


@pytest.mark.parametrize(
    ("bring_on", "why"),
    [
        (lambda press: press.reach_in(1.0), "Doors-CURTAIN_OK"),
        (lambda press: press.open_door(20.0), "Doors-FRONT_CLOSED"),
        (lambda press: press.press_stop(0.5), "Panel-STOP"),
        (lambda press: press.press_emergency_stop(5.0), "Cabinet-E_STOP_OK"),
        (lambda press: press.stop_at_end_of_cycle(200.0), "cycle stop"),
        (lambda press: press.starve(1200.0), "Infeed-WAITING"),
    ],
)
def test_stops_that_are_no_failure_raise_the_alarm_bit(
    bring_on: Callable[[RunningPress], None], why: str
) -> None:
    press = RunningPress(START_NS, seed=4)
    alarm = len(SYMBOLS) - 1
    assert SYMBOLS[alarm].address == MODES["alarm"][0]
    rose: list[int] = []
    press.on_change(lambda _, number, value: rose.append(value) if number == alarm else None)
    run(press, 2)
    assert 1 not in rose
    bring_on(press)
    run(press, 6)
    assert [reason for _, reason in press.stops] == [why]
    assert press.alarms == ()
    assert [value for value in rose if value] == [1]
    assert rose[-1] == 0, "the press goes on without the key"


def test_a_worn_cushion_rebounds_more_and_more_until_the_press_stops() -> None:
    press = RunningPress(START_NS, seed=6)
    rebounds: list[int] = []
    sensor = next(n for n, symbol in enumerate(SYMBOLS) if symbol.short_name == "Clamp2-ADV")
    press.on_change(lambda time_ns, n, value: rebounds.append(time_ns) if n == sensor else None)
    run(press, 10)
    sound = len(rebounds)
    worn_out_ns = press.now_ns + 3 * 3600 * 10**9
    press.wear_out("Clamp2", 3 * 3600.0)
    run(press, 230)
    assert [why for _, why in press.alarms] == ["Clamp2-ADV"]
    assert press.alarms[0][0] >= worn_out_ns
    half_ns = worn_out_ns - 3 * 1800 * 10**9
    life = [time_ns for time_ns in rebounds[sound:] if time_ns < worn_out_ns]
    early = sum(time_ns < half_ns for time_ns in life)
    assert len(life) - early > early, "more rebounds in the second half of its life"
    gone_ns = press.alarms[0][0]
    run(press, press.cycles + 10)
    again = [why for time_ns, why in press.alarms if time_ns > gone_ns]
    assert again == [], "whoever mended it changed it"


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
