"""Late transitions by the truth (`benches.late_by_truth`)."""

import pytest

from benches.late_by_truth import Late, insert_late
from benches.plants import Bodyshop, bodyshop
from runglight.injection import Distribution

OVER = Distribution("normal", 1.0, 2.5)


@pytest.fixture(scope="module")
def plant() -> Bodyshop:
    return bodyshop("tiny", 1)


@pytest.fixture(scope="module")
def late(plant: Bodyshop) -> Late:
    return insert_late(plant, 40, OVER, seed=3)


def test_every_label_is_an_event_of_the_changed_log(late: Late) -> None:
    time_ns, signal, value = late.log.columns()
    events = {
        (int(time), f"{late.log.signals[index]}_{'ON' if on else 'OFF'}")
        for time, index, on in zip(time_ns, signal, value, strict=True)
    }
    assert len(late.labels) == 40
    for label in late.labels:
        assert label.size_s is not None
        assert 1.0 <= label.size_s <= 2.5
        assert (label.time_ns + round(label.size_s * 1e9), label.to_state) in events


def test_each_device_keeps_its_order(plant: Bodyshop, late: Late) -> None:
    def chains(log: object) -> dict[str, list[tuple[str, int]]]:
        found: dict[str, list[tuple[str, int]]] = {}
        _, signals, values = log.columns()  # type: ignore[attr-defined]
        names = log.signals  # type: ignore[attr-defined]
        for index, value in zip(signals.tolist(), values.tolist(), strict=True):
            device = names[index].rsplit("-", 1)[0]
            found.setdefault(device, []).append((names[index], value))
        return found

    before, after = chains(plant.watch), chains(late.log)
    assert {device: sorted(chain) for device, chain in before.items()} == {
        device: sorted(chain) for device, chain in after.items()
    }
    assert sum(before[device] == after[device] for device in before) == len(before)


def test_waits_and_what_cannot_be_seen_are_named(plant: Bodyshop) -> None:
    late = insert_late(plant, 200, OVER, seed=1)
    labels = {label.id: label for label in late.labels}
    assert late.waits
    for name in late.waits:
        assert plant.waiting(labels[name])
    assert not late.waits & late.hidden


def test_the_same_seed_gives_the_same(plant: Bodyshop, late: Late) -> None:
    assert insert_late(plant, 40, OVER, seed=3).labels == late.labels
    assert insert_late(plant, 40, OVER, seed=4).labels != late.labels
