"""Findings on disk."""

import json
import sqlite3
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from runglight.findings import store as findings_store
from runglight.findings.store import FindingStore


def line(finding_id: str, state: str) -> str:
    return json.dumps({"id": finding_id, "state": state})


def test_the_newest_line_counts(tmp_path: Path) -> None:
    with FindingStore(tmp_path) as store:
        store.append([line("a", "suspected"), line("b", "suspected")])
        store.append([line("a", "returned")])
    with FindingStore(tmp_path, create=False) as store:
        assert store.newest("a") == line("a", "returned")
        assert store.newest("b") == line("b", "suspected")
        assert store.newest("c") is None


def test_watching_the_same_log_again_writes_nothing_twice(tmp_path: Path) -> None:
    with FindingStore(tmp_path) as store:
        for _ in range(3):
            store.append([line("a", "suspected"), line("a", "returned")], [json.dumps({"id": "s"})])
        assert store.newest("a") == line("a", "returned")
    with sqlite3.connect(tmp_path / "findings.sqlite") as connection:
        assert connection.execute("SELECT count(*) FROM finding").fetchone() == (2,)
        assert connection.execute("SELECT count(*) FROM snapshot").fetchone() == (1,)
    connection.close()


# Few ids and few states, so that lines come again: side by side, and among others.
LINES = st.builds(line, st.sampled_from("abcde"), st.sampled_from("xyz"))


@settings(
    deadline=None, max_examples=100, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(appended=st.lists(st.lists(LINES, max_size=12), max_size=6), with_ids=st.booleans())
def test_every_line_is_there_once_in_the_order_it_first_came(
    monkeypatch: pytest.MonkeyPatch, appended: list[list[str]], with_ids: bool
) -> None:
    monkeypatch.setattr(findings_store, "_LINES_AT_ONCE", 3)
    with FindingStore(None) as store:
        for lines in appended:
            ids = [json.loads(each)["id"] for each in lines] if with_ids else None
            store.append(lines, ids=ids)
        kept = [each.line for each in store.after(0, 1000)]
    assert kept == list(dict.fromkeys(each for lines in appended for each in lines))


def test_a_log_watched_again_with_another_end(tmp_path: Path) -> None:
    lines = [line(f"f-{number}", "suspected") for number in range(600)]
    other = [
        *lines[:400],
        *(line(f"g-{number}", "suspected") for number in range(300)),
        *lines[400:],
    ]
    with FindingStore(tmp_path) as store:
        store.append(lines)
        store.append(other)
        kept = [each.line for each in store.after(0, 1000)]
    assert kept == [*lines, *other[400:700]]


def test_nearest_ids(tmp_path: Path) -> None:
    with FindingStore(tmp_path) as store:
        store.append([line(f"f-{number:04}", "suspected") for number in range(50)])
        assert store.nearest_ids("f-00411")[0] == "f-0041"
        assert store.nearest_ids("zzz") == ["f-0049", "f-0048", "f-0047"]


def test_a_missing_store_is_not_made_by_looking(tmp_path: Path) -> None:
    with (
        pytest.raises(sqlite3.OperationalError),
        FindingStore(tmp_path, create=False) as store,
    ):
        store.newest("a")
    assert not list(tmp_path.iterdir())
