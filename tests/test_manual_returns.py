"""An operator moves the machine by hand and starts it again: no finding, in either mode."""

import json

import pytest

from benches import press_days
from benches.press_scoring import nanoseconds
from runglight.model import learn_cycle
from runglight.plants.press import MODES, REGIONS, SYMBOLS
from runglight.plants.symbols import write_symbols


@pytest.mark.parametrize("mode", ["element", "word"])
def test_returns_from_manual_tell_nothing(
    mode: str, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Both modes look at the same days.
    folder = tmp_path_factory.getbasetemp() / "manual"
    folder.mkdir(exist_ok=True)
    monkeypatch.setattr(press_days, "FOLDER", folder)
    symbols = folder / "symbols.csv"
    write_symbols(SYMBOLS, symbols)
    # After fewer cycles sound operation itself tells something now and then.
    nominal = press_days.operation("nominal", seed=1, cycles=200)
    days = press_days.operation("manual", seed=4, cycles=80, normal=("manual",) * 20)
    model = learn_cycle(nominal.log, MODES, REGIONS, symbols=symbols, mode=mode)
    time_ns, signal, value = days.log.columns()
    manual = days.log.signals.index("Checks-Mode-MANUAL")
    returns = time_ns[(signal == manual) & (value == 0)][1:].tolist()
    assert len(returns) == 20
    monitor = model.monitor()
    lines = monitor.observe(days.log).json_lines() + monitor.finish().json_lines()
    findings = [each for each in map(json.loads, lines) if each["state"] != "returned"]
    assert [each for each in findings if each["rank"] in (1, 2)] == []
    # What whole words tell of sound operation comes at any time.
    near = [
        each
        for each in findings
        for back in returns
        if 0 <= nanoseconds(each["time"]) - back < 10 * 10**9
    ]
    assert near == []
