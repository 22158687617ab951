"""Labels survive the file, and the same seed gives the same log."""

from pathlib import Path

import numpy as np
import pytest

from runglight.errors import InputError
from runglight.injection import InjectionPlan, inject_with, read_labels, write_labels
from runglight.injection.labels import iso, nanoseconds
from runglight.log.changelog import Log
from runglight.model import NominalModel

PLAN = InjectionPlan(faults=10, late=10, early=3, stalls=1, seed=7)


def test_there_and_back(clean: Log, model: NominalModel, tmp_path: Path) -> None:
    labels = inject_with(clean, PLAN, model).labels
    write_labels(labels, tmp_path / "labels.json")
    assert read_labels(tmp_path / "labels.json") == labels
    assert '"from": "Group1-' in (tmp_path / "labels.json").read_text(encoding="utf-8")


@pytest.mark.parametrize("time_ns", [0, 1, 1_767_592_800_123_456_789, 1_767_592_800_000_000_000])
def test_times(time_ns: int) -> None:
    assert nanoseconds(iso(time_ns)) == time_ns


def test_what_is_no_labels_is_refused(tmp_path: Path) -> None:
    for text in ("", "{}", '[{"id": "F1"}]', "\xff"):
        (tmp_path / "labels.json").write_text(text, encoding="latin-1")
        with pytest.raises(InputError, match="no labels of injected faults"):
            read_labels(tmp_path / "labels.json")


def test_the_seed_decides(clean: Log, model: NominalModel) -> None:
    def columns(seed: int) -> list[np.ndarray]:
        plan = InjectionPlan(faults=10, late=10, stalls=1, seed=seed)
        return list(inject_with(clean, plan, model).log.columns())

    assert all(map(np.array_equal, columns(1), columns(1)))
    assert not all(map(np.array_equal, columns(1), columns(2)))


def test_nothing_asked_for_is_nothing_done(clean: Log, model: NominalModel) -> None:
    injected = inject_with(clean, InjectionPlan(), model)
    assert injected.labels == []
    assert all(map(np.array_equal, injected.log.columns(), clean.columns()))


def test_plans_that_make_no_sense_are_refused() -> None:
    for wrong in (
        {"faults": -1},
        {"after": 1.0},
        {"spacing_s": -1.0},
        {"stuck_cycles": (2, 1)},
        {"shift_by": 0.0},
        {"shift_passes": 0},
        {"faults": 1, "kinds": ()},
    ):
        with pytest.raises(InputError):
            InjectionPlan(**wrong)  # type: ignore[arg-type]
