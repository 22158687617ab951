"""Folds and judgements (`benches.budget`)."""

from benches.budget import folds, judged
from benches.plants import cell


def test_every_row_is_watched_once_and_never_by_what_it_taught() -> None:
    log = cell(5, seed=1)
    parts = list(folds(log))
    assert sum(len(watched) for _, watched in parts) == len(log)
    for learned, watched in parts:
        assert sum(map(len, learned)) + len(watched) == len(log)


def test_a_budget_is_judged_by_its_bounds() -> None:
    assert judged({"alarms": 0, "days": 40.0}, 0.1) == "kept"
    assert judged({"alarms": 0, "days": 0.01}, 0.1) == "not refuted"
    assert judged({"alarms": 9, "days": 1.0}, 0.1) == "**broken**"
