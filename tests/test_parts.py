"""Monitors of a model's parts, put together, tell what one monitor of the whole tells."""

import json
from random import Random

import numpy as np
import pytest

from runglight.errors import InputError
from runglight.injection import InjectionPlan, inject
from runglight.log.changelog import Log
from runglight.model import NominalModel, learn
from runglight.plants.bodyshop import simulate_bodyshop
from runglight.plants.run import PlantRun

FAULTS = InjectionPlan(faults=12, late=6, stalls=2, seed=3, after=0.0)


def as_log(run: PlantRun) -> Log:
    return Log.from_columns(run.time_ns, run.signal_index, run.value, run.signals)


def with_a_stranger(log: Log) -> Log:
    """The log, with a signal in the middle that no model knows."""
    time_ns, signal, value = log.columns()
    at = len(log) // 2
    stranger = np.uint32(len(log.signals))
    return Log.from_columns(
        np.insert(time_ns, at, time_ns[at]),
        np.insert(signal, at, stranger),
        np.insert(value, at, 1),
        [*log.signals, "Stranger"],
    )


@pytest.fixture(scope="module")
def bodyshop() -> tuple[NominalModel, Log]:
    """A small body shop of two groups, and a log of it with faults."""
    run = simulate_bodyshop("tiny", learn_events=12_000, watch_events=6_000)
    model = learn(as_log(run.learn), false_alarms_per_day=1000.0)
    return model, with_a_stranger(inject(as_log(run.watch), FAULTS).log)


def lines_of_whole(model: NominalModel, log: Log) -> set[str]:
    monitor = model.monitor()
    return {*monitor.observe(log).json_lines(), *monitor.finish().json_lines()}


def begin(log: Log) -> tuple[int, bool]:
    """When a log begins, and whether its first rows are an image."""
    time_ns, _, value = log.columns()
    return int(time_ns[0]), bool((value[time_ns == time_ns[0]] == 0).any())


def own_rows(model: NominalModel, groups: list[str], log: Log) -> Log:
    """The rows of some groups, and, for the first part, of signals nobody knows."""
    of_signal = model.groups_of(log.signals)
    first = model.groups[0] in groups
    wanted = [group in groups or (group is None and first) for group in of_signal]
    time_ns, signal, value = log.columns()
    kept = np.array(wanted)[signal]
    return Log.from_columns(time_ns[kept], signal[kept], value[kept], log.signals)


def lines_of_part(model: NominalModel, groups: list[str], log: Log, rows: Log) -> set[str]:
    """Rows in small batches, each watched by a monitor that goes on from saved bytes."""
    part = model.part(groups)
    monitor = part.monitor()
    first, image = begin(log)
    monitor.begin(first, image=image)
    state, lines = monitor.state(), set()
    cuts = sorted(Random(7).sample(range(len(rows)), 40))
    for start, end in zip([0, *cuts], [*cuts, len(rows)], strict=True):
        monitor = part.monitor(state=state)
        lines.update(monitor.observe(rows.slice(start, end - start)).json_lines())
        state = monitor.state()
    monitor = part.monitor(state=state)
    lines.update(monitor.advance(int(log.columns()[0][-1])).json_lines())
    lines.update(monitor.finish().json_lines())
    return lines


def test_parts_tell_together_what_the_whole_tells(bodyshop: tuple[NominalModel, Log]) -> None:
    model, log = bodyshop
    whole = lines_of_whole(model, log)
    kinds = {json.loads(line)["kind"] for line in whole}
    assert kinds >= {"transition", "late", "unknown_signal", "alarm_path"}
    assert len(model.parts()) == 2
    of_parts = [
        lines_of_part(model, groups, log, own_rows(model, groups, log)) for groups in model.parts()
    ]
    assert set.union(*of_parts) == whole
    assert all(lines < whole for lines in of_parts)


def test_rows_of_other_parts_are_passed_over(bodyshop: tuple[NominalModel, Log]) -> None:
    model, log = bodyshop
    for groups in model.parts():
        own = lines_of_part(model, groups, log, own_rows(model, groups, log))
        assert lines_of_part(model, groups, log, log) == own


def test_a_part_is_smaller(bodyshop: tuple[NominalModel, Log]) -> None:
    model, log = bodyshop
    one = model.part(model.groups[:1])
    assert one.groups == model.groups[:1]
    assert len(one.signals) < len(model.signals)
    assert set(one.signals) < set(model.signals)
    sizes = []
    for watched in (model, one):
        monitor = watched.monitor()
        monitor.observe(log)
        sizes.append(len(monitor.state()))
    assert sizes[1] < 0.7 * sizes[0]


def test_a_gap_is_one_finding(bodyshop: tuple[NominalModel, Log]) -> None:
    model, log = bodyshop
    start, _ = begin(log)
    told = [
        model.part(groups).monitor().gap(start, start + 10**9).json_lines()
        for groups in model.parts()
    ]
    assert told[0] == told[1] != []


def test_a_part_is_neither_saved_nor_changed(
    bodyshop: tuple[NominalModel, Log], tmp_path: object
) -> None:
    model, log = bodyshop
    part = model.part(model.groups[0])
    assert part.is_part
    assert not model.is_part
    with pytest.raises(InputError, match="save the whole model"):
        part.save(f"{tmp_path}/part.model")
    with pytest.raises(InputError, match="cut the whole model"):
        part.part(part.groups)
    finding = next(line for line in lines_of_whole(model, log) if '"alarm_path"' in line)
    with pytest.raises(InputError, match="on the whole one"):
        part.confirm(finding)


def test_what_is_no_part_is_refused(bodyshop: tuple[NominalModel, Log]) -> None:
    model, _ = bodyshop
    with pytest.raises(InputError, match="no group 'Nowhere'"):
        model.part(["Nowhere"])
    with pytest.raises(InputError, match="needs a group"):
        model.part([])
    one, other = (model.part(groups) for groups in model.parts())
    with pytest.raises(InputError, match="belongs to another model"):
        one.monitor(state=other.monitor().state())


def test_groups_of_signals(bodyshop: tuple[NominalModel, Log]) -> None:
    model, _ = bodyshop
    asked = [model.signals[-1], "Stranger", model.signals[0]]
    groups = model.groups_of(asked)
    assert groups[1] is None
    assert {groups[0], groups[2]} <= set(model.groups)
    part = model.part(model.groups[0])
    assert part.groups_of(asked) == groups
