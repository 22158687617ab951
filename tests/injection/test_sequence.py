"""Faults of order depart from the clean log exactly as labelled."""

import pytest

from runglight.injection import InjectionKind, InjectionPlan, inject, inject_with, score
from runglight.injection.kinds import SEQUENCE_KINDS
from runglight.log.changelog import Log
from runglight.model import NominalModel
from tests.conftest import simulated
from tests.injection.chain_reading import chains, transitions

SEEDS = (1, 2, 3)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("kind", SEQUENCE_KINDS)
def test_each_kind_departs_as_labelled(
    clean: Log, model: NominalModel, kind: InjectionKind, seed: int
) -> None:
    injected = inject_with(clean, InjectionPlan(faults=8, kinds=(kind,), seed=seed), model)
    assert [label.kind for label in injected.labels] == [kind] * 8
    known, made = transitions(clean), transitions(injected.log)
    for label in injected.labels:
        assert label.from_state is not None
        assert label.to_state is not None
        departing = label.from_state, label.to_state
        assert departing not in known
        assert label.time_ns in [time for time, _ in made[departing]]
        assert label.start_ns <= label.time_ns <= label.end_ns
        assert label.signal is not None
        assert label.signal.startswith(f"{label.group}-{label.device}-")
    # And nothing else departs: every unknown transition lies within a label of its device.
    for states, passes in made.items():
        if states in known:
            continue
        device = states[0].rsplit("-", 1)[0]
        for time, _ in passes:
            assert any(
                label.start_ns <= time <= label.end_ns
                for label in injected.labels
                if f"{label.group}-{label.device}" == device
            ), (states, time)


@pytest.mark.parametrize("kind", SEQUENCE_KINDS)
def test_only_the_labelled_device_changes(
    clean: Log, model: NominalModel, kind: InjectionKind
) -> None:
    injected = inject_with(clean, InjectionPlan(faults=1, kinds=(kind,)), model)
    (label,) = injected.labels
    before, after = chains(clean), chains(injected.log)
    assert {device for device in before if before[device] != after[device]} == {
        f"{label.group}-{label.device}"
    }


def rows_of(log: Log) -> list[tuple[int, str, int]]:
    time, index, value = (column.tolist() for column in log.columns())
    return [
        (at, log.signals[signal], now) for at, signal, now in zip(time, index, value, strict=True)
    ]


def one(clean: Log, model: NominalModel, kind: InjectionKind, **said: object) -> tuple[list, list]:
    """Rows that one fault took away, and rows that it added."""
    plan = InjectionPlan(faults=1, kinds=(kind,), **said)  # type: ignore[arg-type]
    injected = inject_with(clean, plan, model)
    before, after = set(rows_of(clean)), set(rows_of(injected.log))
    return sorted(before - after), sorted(after - before)


@pytest.mark.parametrize("cycles", [1, 2, 4])
@pytest.mark.parametrize(
    ("kind", "first"), [(InjectionKind.STUCK_ON, 0), (InjectionKind.STUCK_OFF, 1)]
)
def test_a_stuck_signal_leaves_whole_cycles_out(
    clean: Log, model: NominalModel, kind: InjectionKind, first: int, cycles: int
) -> None:
    gone, come = one(clean, model, kind, stuck_cycles=(cycles, cycles))
    assert not come
    assert [value for _, _, value in gone] == [first, 1 - first] * cycles
    assert len({signal for _, signal, _ in gone}) == 1


def test_a_pulse_adds_two_edges(clean: Log, model: NominalModel) -> None:
    gone, come = one(clean, model, InjectionKind.SPURIOUS_PULSE)
    assert not gone
    (start, signal, value), (end, same, back) = come
    assert signal == same
    assert back == 1 - value
    assert 0 < end - start <= 500_000_000


def test_swapped_events_exchange_their_times(clean: Log, model: NominalModel) -> None:
    gone, come = one(clean, model, InjectionKind.SWAPPED_ORDER)
    (first, a, was), (second, b, had) = gone
    assert come == [(first, b, had), (second, a, was)]


def test_lost_edges(clean: Log, model: NominalModel) -> None:
    lost = {len(one(clean, model, InjectionKind.MISSING_EDGE, seed=seed)[0]) for seed in range(8)}
    assert lost == {1, 2}


@pytest.mark.parametrize("seed", SEEDS)
def test_the_engine_finds_them_all_on_the_right_device(
    clean: Log, model: NominalModel, seed: int
) -> None:
    injected = inject_with(clean, InjectionPlan(faults=25, seed=seed), model)
    assert len(injected.labels) == 25
    told = score(injected.labels, model.watch(injected.log), tolerance_s=0.0)
    assert told.missed == []
    assert told.false == 0
    assert all(kind.delay_most_s == 0 for kind in told.kinds.values())


def test_what_a_reference_does_is_no_fault(clean: Log) -> None:
    plan = InjectionPlan(faults=60, spacing_s=1)
    reference = inject(clean, plan).log
    injected = inject(clean, InjectionPlan(faults=10), reference=[reference])
    known = transitions(reference)
    assert injected.labels
    for label in injected.labels:
        assert (label.from_state, label.to_state) not in known


def test_more_than_fits_is_said() -> None:
    small = simulated(cycles=5)
    injected = inject(small, InjectionPlan(faults=1000))
    assert 0 < len(injected.labels) < 1000
    (sentence,) = injected.shortfalls
    assert sentence.startswith(f"the log has room for {len(injected.labels)} of the 1,000 faults")
