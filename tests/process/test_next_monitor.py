"""Watching with the network: what it thought very unlikely is told, as a notice."""

import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest

import runglight as rl
from tests.process.counting_tank import RESET, changes, log_of, write_net


@pytest.fixture(scope="module")
def trained(tmp_path_factory: pytest.TempPathFactory) -> rl.NextActivity:
    net = rl.read_net(write_net(tmp_path_factory.mktemp("net") / "tank.pnml"))
    runs = rl.event_log(log_of(changes(22)), reset=RESET)
    return rl.train_next(
        runs, net, rl.TrainingSettings(epochs=200, batch=16, seed=1, patience=None)
    )


def told(trained: rl.NextActivity, log: rl.Log) -> list[dict[str, Any]]:
    monitor = trained.monitor(RESET, unlikely=0.02)
    return [*monitor.observe(log), *monitor.finish()]


def counted_wrong() -> rl.Log:
    """The fifth run is filled twice instead of three times."""
    before, short, after = changes(4), changes(1, fillings=2), changes(3)
    happened = before[:-1]
    for part in (short[1:-1], after[1:]):
        start = happened[-1][0] - part[0][0] + 4.4
        happened += [(start + time, what) for time, what in part]
    return log_of(happened)


def test_what_it_learned_is_no_notice(trained: rl.NextActivity) -> None:
    assert told(trained, log_of(changes(6))) == []


def test_a_run_that_counts_wrong_is_told(trained: rl.NextActivity) -> None:
    [first, *_] = findings = told(trained, counted_wrong())
    assert first["to"] == RESET
    assert first["from"] == "%IX0.2=0"
    assert first["expected"][0]["state"] == "%QX0.0=1 & %QX0.1=0"
    assert "where %QX0.0=1 & %QX0.1=0 was likely" in first["message"]
    for finding in findings:
        assert (finding["severity"], finding["model"]) == ("notice", "process")
        jsonschema.validate(json.loads(json.dumps(finding, default=str)), rl.finding_schema())


def test_an_activity_never_seen_is_told(trained: rl.NextActivity) -> None:
    happened = changes(3)
    time, _ = happened[6]
    happened.insert(6, (time - 0.3, [("%IX0.1", 0), ("%IX0.0", 1)]))
    assert "never seen in training" in told(trained, log_of(happened))[0]["message"]


def test_any_split_gives_the_same_findings(trained: rl.NextActivity) -> None:
    log = counted_wrong()
    whole = told(trained, log)
    assert whole
    for size in (1, 3, 50):
        monitor = trained.monitor(RESET, unlikely=0.02)
        findings: list[dict[str, Any]] = []
        for offset in range(0, len(log), size):
            findings += monitor.observe(log.slice(offset, size))
            monitor = trained.monitor(RESET, unlikely=0.02, state=monitor.state())
        assert findings + list(monitor.finish()) == whole


def test_states_are_checked(trained: rl.NextActivity) -> None:
    state = trained.monitor(RESET).state()
    with pytest.raises(rl.InputError, match="damaged"):
        trained.monitor(RESET, state=state[:-1])
    with pytest.raises(rl.InputError, match="another model"):
        trained.monitor(RESET, unlikely=0.5, state=state)


def test_a_gap_ends_the_run(trained: rl.NextActivity) -> None:
    log = counted_wrong()
    monitor = trained.monitor(RESET, unlikely=0.02)
    middle = next(
        i for i, row in enumerate(zip(*log.engine.columns(), strict=True)) if row[0] > 180e9
    )
    monitor.observe(log.slice(0, middle))
    time = int(log.engine.columns()[0][middle])
    assert list(monitor.gap(time - 5, time - 1)) == []
    assert not [*monitor.observe(log.slice(middle, 3))], "where the run stands is not known"


@pytest.mark.parametrize("reset", ["", "%IX0.1", "%IX9.9=0"])
def test_a_reset_the_network_does_not_know(trained: rl.NextActivity, reset: str) -> None:
    with pytest.raises(rl.InputError, match="must be SIGNAL=VALUE"):
        trained.monitor(reset)


def test_rows_that_run_backwards_are_refused(trained: rl.NextActivity, tmp_path: Path) -> None:
    monitor = trained.monitor(RESET)
    monitor.observe(log_of(changes(2)))
    with pytest.raises(rl.InputError, match="time order"):
        monitor.observe(log_of(changes(1)))
