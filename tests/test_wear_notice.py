"""A rising rate of class 3 and 4 at an address is told before the class 1; without wear never."""

import json
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from runglight.log.changelog import Log
from runglight.model import learn_cycle
from runglight.plants.image_log import ImageLog
from runglight.plants.press import MODES, REGIONS, SYMBOLS, RunningPress, simulate_press
from runglight.plants.press.simulate import SLICE_NS, START_NS
from runglight.plants.symbols import write_symbols

HOUR_S = 3600.0
HOURS = 9


@cache
def nominal() -> Log:
    """What is learned from."""
    run = simulate_press(300, seed=1)
    return Log.from_columns(run.time_ns, run.signal_index, run.value, run.signals)


@cache
def operated(*, worn: bool) -> Log:
    """Nine hours of the press, in which clamp 2 wears out from the first to the eighth."""
    press = RunningPress(START_NS, seed=7)
    log = ImageLog(press, START_NS)
    now_ns = START_NS
    while now_ns < START_NS + HOURS * HOUR_S * 1e9:
        before_ns, now_ns = now_ns, now_ns + SLICE_NS
        press.advance(now_ns)
        if worn and before_ns < START_NS + HOUR_S * 1e9 <= now_ns:
            press.wear_out("Clamp2", 7 * HOUR_S)
    run = log.run(now_ns, [symbol.name for symbol in SYMBOLS])
    made = Log.from_columns(run.time_ns, run.signal_index, run.value, run.signals)
    assert [why for _, why in press.alarms] == (["Clamp2-ADV"] if worn else [])
    return made


@pytest.fixture(scope="module", params=["element", "word"])
def findings(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Any:
    symbols = Path(tmp_path_factory.mktemp("press")) / "symbols.csv"
    write_symbols(SYMBOLS, symbols)
    model = learn_cycle(
        nominal(), MODES, REGIONS, symbols=symbols, mode=request.param, rate_window=150
    )

    def of(*, worn: bool) -> list[dict[str, Any]]:
        log = operated(worn=worn)
        monitor = model.monitor()
        lines = monitor.observe(log).json_lines() + monitor.finish().json_lines()
        return [json.loads(line) for line in lines]

    return of


def test_growth_is_told_before_the_failure(findings: Any) -> None:
    told = findings(worn=True)
    rises = [each for each in told if "more and more often" in each["message"]]
    [failure] = [each for each in told if each["rank"] == 1]
    assert rises
    assert rises[0]["time"] < failure["time"]
    assert {each["device"] for each in rises} == {"Clamp2"} == {failure["device"]}
    assert {each["severity"] for each in rises} == {"notice"}
    assert failure["suspects"][0]["address"] == "I12.2"


def test_without_wear_nothing_grows(findings: Any) -> None:
    told = findings(worn=False)
    assert [each for each in told if "more and more often" in each["message"]] == []
    assert [each for each in told if each["rank"] in (1, 2)] == []
