"""Late and early transitions, stalls, and shifts: sizes, order, and what follows."""

from itertools import pairwise

import numpy as np
import pytest

from runglight.injection import (
    Distribution,
    InjectionKind,
    InjectionPlan,
    distribution,
    inject,
    inject_with,
    score,
)
from runglight.log.changelog import Log
from runglight.model import NominalModel, learn
from tests.injection.chain_reading import chains, transitions, true_times


def states(log: Log) -> dict[str, list[str]]:
    return {device: [event.state for event in chain] for device, chain in chains(log).items()}


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_late_transitions_take_as_long_as_labelled(
    clean: Log, model: NominalModel, seed: int
) -> None:
    injected = inject_with(clean, InjectionPlan(late=30, seed=seed), model)
    assert len(injected.labels) == 30
    true, made = true_times(clean), transitions(injected.log)
    for label in injected.labels:
        assert label.kind is InjectionKind.LATE
        assert label.size_s is not None
        assert 1.0 <= label.size_s <= 2.5
        transition = str(label.from_state), str(label.to_state)
        most = true[transition][1]
        took = most + round(label.size_s * 1e9)
        assert (label.time_ns - most + took, took) in made[transition]
    # The order of every device stays; nothing else is slower or faster than it ever was.
    assert states(injected.log) == states(clean)
    late = [took for passes in made.values() for _, took in passes]
    over = [
        transition
        for transition, passes in made.items()
        for at, took in passes
        if at > clean.columns()[0][0] and not true[transition][0] <= took <= true[transition][1]
    ]
    assert len(late) > 3000
    assert len(over) == 30


def test_early_transitions_take_as_long_as_labelled(clean: Log, model: NominalModel) -> None:
    injected = inject_with(clean, InjectionPlan(early=10), model)
    assert len(injected.labels) == 10
    true, made = true_times(clean), transitions(injected.log)
    for label in injected.labels:
        assert label.size_s is not None
        transition = str(label.from_state), str(label.to_state)
        took = true[transition][0] - round(label.size_s * 1e9)
        assert (label.time_ns, took) in made[transition]
    assert states(injected.log) == states(clean)


@pytest.mark.parametrize(
    ("text", "mean", "deviation"),
    [
        ("normal:1.0:2.5", 1.75, 0.25),
        ("uniform:1:3", 2.0, 2 / 12**0.5),
        ("constant:2", 2.0, 0.0),
    ],
)
def test_sizes_follow_the_distribution(text: str, mean: float, deviation: float) -> None:
    chosen = distribution(text)
    assert str(chosen) in {text, text.replace(".0", "")}
    drawn = chosen.draw_s(np.random.default_rng(1), 20_000)
    assert chosen.least_s <= drawn.min() <= drawn.max() <= chosen.most_s
    assert drawn.mean() == pytest.approx(mean, abs=0.02)
    assert drawn.std() == pytest.approx(deviation, abs=0.02)


def test_injected_sizes_follow_the_distribution() -> None:
    from tests.conftest import simulated  # noqa: PLC0415

    plan = InjectionPlan(late=400, late_over=Distribution("normal", 1.0, 3.0), spacing_s=1.0)
    sizes = np.array([label.size_s for label in inject(simulated(cycles=600), plan).labels])
    assert len(sizes) == 400
    assert sizes.mean() == pytest.approx(2.0, abs=0.05)
    assert sizes.std() == pytest.approx(1 / 3, abs=0.04)


def test_everything_together_stays_in_order(clean: Log, model: NominalModel) -> None:
    plan = InjectionPlan(faults=15, late=10, early=3, stalls=2, seed=4)
    injected = inject_with(clean, plan, model)
    time = injected.log.columns()[0]
    assert (np.diff(time) >= 0).all()
    # On the clock of the clean log, which has 10 ms.
    assert (np.diff(time) % 10_000_000 == 0).all()
    assert len(injected.labels) == 30
    assert [label.id for label in injected.labels] == [f"F{number:05}" for number in range(1, 31)]
    assert all(a.time_ns <= b.time_ns for a, b in pairwise(injected.labels))


def test_faults_keep_their_distance(clean: Log, model: NominalModel) -> None:
    plan = InjectionPlan(faults=10, spacing_s=120.0, after=0.5)
    injected = inject_with(clean, plan, model)
    time = clean.columns()[0]
    assert injected.labels[0].start_ns >= (time[0] + time[-1]) // 2
    for before, after in pairwise(injected.labels):
        assert after.start_ns - before.start_ns > 120_000_000_000


def test_a_stall_is_silence(clean: Log, model: NominalModel) -> None:
    injected = inject_with(clean, InjectionPlan(stalls=2), model)
    time = injected.log.columns()[0]
    longest = int(np.diff(clean.columns()[0][:-1]).max())
    assert len(injected.labels) == 2
    for label in injected.labels:
        assert label.device is None
        assert label.size_s == 240
        assert not ((time > label.start_ns) & (time < label.end_ns)).any()
        assert label.start_ns in time
        assert label.end_ns in time
        assert label.end_ns - label.start_ns == longest + 240_000_000_000
        assert label.time_ns == label.start_ns + longest
    assert len(injected.log) == len(clean)
    told = score(injected.labels, model.watch(injected.log))
    assert (told.found, told.false) == (2, 0)


def test_shifted_times(clean: Log, model: NominalModel) -> None:
    injected = inject_with(clean, InjectionPlan(time_shifts=1, shift_passes=45), model)
    (label,) = injected.labels
    transition = str(label.from_state), str(label.to_state)

    def long_share(log: Log) -> float:
        passes = [
            took
            for at, took in transitions(log)[transition]
            if label.start_ns <= at <= label.end_ns
        ]
        middle = sum(true_times(clean)[transition]) / 2
        return sum(took > middle for took in passes) / len(passes)

    assert abs(long_share(injected.log) - long_share(clean)) > 0.25
    assert label.share is not None
    assert label.share >= 0.3
    assert set(transitions(injected.log)) <= set(transitions(clean))
    told = score(injected.labels, model.watch(injected.log))
    assert (told.found, told.false) == (1, 0)


def sorter(cycles: int = 400) -> Log:
    """A pusher that goes left for three parts in ten, right for the others."""
    random = np.random.default_rng(1)
    names = ["Line-Pusher-HOME", "Line-Pusher-LEFT", "Line-Pusher-RIGHT", "Line-Belt-RUN"]
    rows: list[tuple[int, int, int]] = []
    time = 0
    for _ in range(cycles):
        side = 1 if random.random() < 0.3 else 2
        for signal, value, least, most in (
            (3, 1, 4000, 6000),
            (0, 0, 400, 600),
            (side, 1, 900, 1100),
            (side, 0, 400, 600),
            (0, 1, 900, 1100),
            (3, 0, 400, 600),
        ):
            time += int(random.integers(least, most)) * 1_000_000
            rows.append((time, signal, value))
    columns = np.array(rows, dtype=np.int64).T
    return Log.from_columns(columns[0], columns[1].astype(np.uint32), columns[2], names)


def test_shifted_branches() -> None:
    clean = sorter()
    injected = inject(clean, InjectionPlan(branch_shifts=1, shift_passes=100))
    (label,) = injected.labels
    assert label.to_state == "Line-Pusher-LEFT_ON"
    home = [
        (at, following == label.to_state)
        for (current, following), passes in transitions(injected.log).items()
        if current == label.from_state
        for at, _ in passes
    ]
    within = [left for at, left in home if label.start_ns <= at <= label.end_ns]
    outside = [left for at, left in home if not label.start_ns <= at <= label.end_ns]
    assert 0.6 < sum(within) / len(within) < 0.8
    assert 0.2 < sum(outside) / len(outside) < 0.4
    # No order, and no time, that the clean log does not have.
    true = true_times(clean)
    for transition, passes in transitions(injected.log).items():
        for _, took in passes:
            assert true[transition][0] <= took <= true[transition][1]
    told = score(injected.labels, learn(clean).watch(injected.log))
    assert told.found == 1


def test_too_much_is_refused() -> None:
    with pytest.raises(Exception, match=r"late_over.*normal:3:1.*no distribution"):
        distribution("normal:3:1", "late_over")
    for text in ("normal:1", "constant:0", "cauchy:1:2", "uniform:1:x", "constant:nan", ""):
        with pytest.raises(Exception, match="no distribution"):
            distribution(text)
