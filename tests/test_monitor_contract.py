"""The contract of every monitor: however the log is cut, the findings are the same."""

import json

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from runglight.log.changelog import Log
from runglight.model import NominalModel, learn
from runglight.plants.bodyshop import simulate_bodyshop
from tests.conftest import simulated

QUICKLY = settings(
    max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


def whole(model: NominalModel, fault: int) -> list[str]:
    monitor = model.monitor()
    return (
        monitor.observe(simulated(seed=2, fault=fault)).json_lines() + monitor.finish().json_lines()
    )


@pytest.mark.parametrize("fault", [1, 2, 5, 9])
@QUICKLY
@given(data=st.data())
def test_any_split_and_any_restore(
    nominal_model: NominalModel, fault: int, data: st.DataObject
) -> None:
    log = simulated(seed=2, fault=fault)
    cuts = sorted(data.draw(st.sets(st.integers(0, len(log)), max_size=6)))
    monitor = nominal_model.monitor()
    lines: list[str] = []
    for start, end in zip([0, *cuts], [*cuts, len(log)], strict=True):
        lines += monitor.observe(log.slice(start, end - start)).json_lines()
        if data.draw(st.booleans()):
            monitor = nominal_model.monitor(state=monitor.state())
    lines += monitor.finish().json_lines()
    assert lines == whole(nominal_model, fault)


@pytest.mark.parametrize("fault", [1, 5])
@QUICKLY
@given(data=st.data())
def test_rows_are_observed_where_they_lie_as_their_slice_is(
    nominal_model: NominalModel, fault: int, data: st.DataObject
) -> None:
    sound = simulated(seed=2, fault=fault)
    times = sound.columns()[0].tolist()
    gaps = data.draw(st.lists(st.tuples(*2 * [st.sampled_from(times)]), max_size=3))
    log = Log.from_columns(
        *sound.columns(), sound.signals, gaps=sorted({(min(gap), max(gap)) for gap in gaps})
    )
    cuts = sorted(data.draw(st.sets(st.integers(0, len(log)), max_size=3)))
    sliced, in_place = nominal_model.monitor(), nominal_model.monitor()
    for start, end in zip([0, *cuts], [*cuts, len(log) + 7], strict=True):
        expected = sliced.observe(log.slice(start, end - start)).json_lines()
        told = in_place.observe_slice(log, start, end - start).told()
        assert told.lines == expected
        findings = [json.loads(each) for each in expected]
        assert told.ids == [each["id"] for each in findings]
        assert told.kinds == [each["kind"] for each in findings]
        assert told.severities == [each["severity"] for each in findings]
    assert in_place.state() == sliced.state()


@pytest.mark.parametrize("timing", ["plat", "adaptive"])
def test_findings_told_together_are_those_told_one_by_one(timing: str) -> None:
    run = simulate_bodyshop("tiny", 1)
    learned, watched = (
        Log.from_columns(part.time_ns, part.signal_index, part.value, part.signals)
        for part in (run.learn, run.watch)
    )
    model = learn(learned, timing=timing)
    together, one_by_one = model.monitor(), model.monitor()
    expected = together.observe(watched).json_lines()
    lines: list[str] = []
    for start in range(0, len(watched), 100):
        lines += one_by_one.observe_slice(watched, start, 100).json_lines()
    assert lines == expected
    transitions = [(each["from"], each["to"]) for each in map(json.loads, lines)]
    # Without a rule that is told of again there was nothing to tell together.
    assert timing == "adaptive" or len(set(transitions)) < len(transitions) / 2


def test_a_model_knows_logs_of_its_signals(nominal_model: NominalModel) -> None:
    log = simulated(seed=2)
    assert nominal_model.knows(log)
    assert nominal_model.knows(log.slice(0, 0))
    assert not nominal_model.knows(log.renamed([*log.signals[:-1], "Never-Seen-BEFORE"]))


def test_observing_row_by_row(nominal_model: NominalModel) -> None:
    log = simulated(seed=2, fault=1)
    monitor = nominal_model.monitor()
    lines = [
        line for row in range(len(log)) for line in monitor.observe(log.slice(row, 1)).json_lines()
    ]
    assert lines + monitor.finish().json_lines() == whole(nominal_model, 1)


def test_a_gap_resynchronises_instead_of_alarming(nominal_model: NominalModel) -> None:
    log = simulated(seed=3)
    time_ns = log.columns()[0].tolist()
    # Recording ends and begins between two scans.
    quiet = [row for row in range(1, len(log)) if time_ns[row] - time_ns[row - 1] > 10**9]
    last, first = quiet[len(quiet) // 3], quiet[2 * len(quiet) // 3]
    monitor = nominal_model.monitor()
    lines = monitor.observe(log.slice(0, last)).json_lines()
    lines += monitor.gap(time_ns[last - 1], time_ns[first]).json_lines()
    lines += monitor.observe(log.slice(first)).json_lines()
    lines += monitor.finish().json_lines()
    findings = [json.loads(line) for line in lines]
    assert [finding["kind"] for finding in findings].count("gap") == 1
    assert {finding["severity"] for finding in findings} == {"notice"}


def test_a_model_survives_saving(
    nominal_model: NominalModel, tmp_path_factory: pytest.TempPathFactory
) -> None:
    from runglight import load_model  # noqa: PLC0415

    directory = tmp_path_factory.mktemp("saved") / "cell.model"
    nominal_model.save(directory)
    again = load_model(directory)
    assert again.rules_json() == nominal_model.rules_json()
    assert whole(again, 1) == whole(nominal_model, 1)
