"""Stops with the alarm bit ON that are no failure: known where they were learned often."""

import json
from collections.abc import Callable, Iterable
from itertools import cycle
from typing import Any

import numpy as np
import pytest

from runglight.log.changelog import Log
from runglight.model import learn_cycle
from runglight.plants.image_log import ImageLog
from runglight.plants.press import MODES, REGIONS, SYMBOLS, RunningPress
from runglight.plants.press.simulate import SLICE_NS, START_NS
from runglight.plants.symbols import write_symbols

Doing = Callable[[RunningPress], object]

REACH_IN: Doing = lambda press: press.reach_in(2.0)  # noqa: E731
PRESS_STOP: Doing = lambda press: press.press_stop(0.5)  # noqa: E731
OPEN_DOOR: Doing = lambda press: press.open_door(30.0)  # noqa: E731


def pressed(doings: Iterable[Doing], *, seed: int, cycles: int, every: int = 4) -> Log:
    """A press at work; every few cycles one of the doings, at different moments."""
    press = RunningPress(START_NS, seed)
    log = ImageLog(press, START_NS)
    ahead = iter(doings)
    now_ns, done = START_NS, 0
    moments = cycle((0, 3, 1, 2))
    while press.cycles < cycles:
        now_ns += SLICE_NS
        press.advance(now_ns)
        if press.cycles >= (done + 1) * every and (doing := next(ahead, None)) is not None:
            for _ in range(next(moments)):
                now_ns += SLICE_NS // 3
                press.advance(now_ns)
            doing(press)
            done += 1
    run = log.run(now_ns, [symbol.name for symbol in SYMBOLS])
    return Log.from_columns(run.time_ns, run.signal_index, run.value, run.signals)


@pytest.fixture(scope="module")
def learned_log() -> Log:
    often = [REACH_IN, PRESS_STOP, OPEN_DOOR] * 4
    # Whole words need thousands of cycles before sound operation tells nothing: `element` here.
    return pressed([*often, lambda press: press.inject(1)], seed=1, cycles=90)


@pytest.fixture(scope="module")
def watched_log() -> Log:
    return pressed([REACH_IN, PRESS_STOP, OPEN_DOOR, PRESS_STOP, REACH_IN], seed=2, cycles=30)


@pytest.fixture(scope="module")
def symbols(tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("press") / "symbols.csv"
    write_symbols(SYMBOLS, path)
    return str(path)


def found(learned: Log, watched: Log, symbols: str, **parameters: Any) -> list[dict[str, Any]]:
    model = learn_cycle(learned, MODES, REGIONS, symbols=symbols, **parameters)
    monitor = model.monitor()
    lines = monitor.observe(watched).json_lines() + monitor.finish().json_lines()
    return [json.loads(line) for line in lines]


def test_a_stop_seen_again_and_again_is_no_failure(
    learned_log: Log, watched_log: Log, symbols: str
) -> None:
    findings = found(learned_log, watched_log, symbols)
    assert [finding for finding in findings if finding["rank"] in (1, 2)] == []
    stops = [finding for finding in findings if "no failure" in finding["message"]]
    assert len(stops) == 5
    assert {finding["rank"] for finding in stops} == {3}
    assert {finding["severity"] for finding in stops} == {"notice"}
    assert "4 times while it was learned" in stops[1]["message"]


def test_asked_so_every_stop_is_a_failure(learned_log: Log, watched_log: Log, symbols: str) -> None:
    findings = found(learned_log, watched_log, symbols, known_stops=0)
    assert sum(finding["rank"] == 1 for finding in findings) == 5


def test_a_stop_never_learned_is_a_failure(watched_log: Log, symbols: str) -> None:
    findings = found(pressed([], seed=1, cycles=60), watched_log, symbols)
    addresses = [f["suspects"][0]["address"] for f in findings if f["rank"] == 1]
    assert addresses == ["I1.5", "I7.4", "I1.0", "I7.4", "I1.5"]


def test_what_broke_once_while_learning_is_a_failure_ever_after(
    learned_log: Log, symbols: str
) -> None:
    broken = pressed([lambda press: press.inject(1)], seed=3, cycles=12)
    [cause] = [f for f in found(learned_log, broken, symbols) if f["rank"] == 1]
    assert cause["suspects"][0]["address"] == "I12.2"


def test_a_failure_beside_a_known_stop_is_a_failure(learned_log: Log, symbols: str) -> None:
    """A sensor drops out, and in the same moment somebody presses STOP."""
    model = learn_cycle(learned_log, MODES, REGIONS, symbols=symbols)
    monitor = model.monitor()
    sound = pressed([], seed=5, cycles=3)
    time_ns, signal, value = sound.columns()
    number = {name: place for place, name in enumerate(sound.signals)}
    clamped = next(
        row
        for row in range(len(sound) // 2, len(sound))
        if signal[row] == number["Actuators-Pin1-ADV"] and value[row] == 1
    )
    end = next(row for row in range(clamped, len(sound)) if time_ns[row] > time_ns[clamped])
    monitor.observe(sound.slice(0, end))
    at_ns = int(time_ns[end - 1]) + 3_000_000
    rows = [
        (at_ns, "Checks-Motors-PROTECTION_3", 0),
        (at_ns, "Checks-Panel-STOP", 1),
        (at_ns + 10_000_000, "Checks-Mode-ALARM", 1),
    ]
    both = Log.from_columns(
        np.array([time for time, _, _ in rows], dtype=np.int64),
        np.arange(len(rows), dtype=np.uint32),
        np.array([value for _, _, value in rows], dtype=np.int64),
        [name for _, name, _ in rows],
    )
    lines = monitor.observe(both).json_lines() + monitor.finish().json_lines()
    ones = [json.loads(line) for line in lines if json.loads(line)["rank"] == 1]
    assert len(ones) == 1
    assert "I4.2" in {suspect["address"] for suspect in ones[0]["suspects"]}


def test_the_model_says_which_stops_it_knows(learned_log: Log, symbols: str) -> None:
    summary = learn_cycle(learned_log, MODES, REGIONS, symbols=symbols).summary()
    known = {
        (sign["address"], sign["showed"], sign["value"])
        for stop in summary["stops"]
        if stop["known"]
        for sign in stop["signs"]
    }
    assert known == {("I1.5", "came", 0), ("I7.4", "came", 1), ("I1.0", "came", 0)}
    assert {s["count"] for s in summary["stops"] if not s["known"]} == {1}
