"""Findings on disk."""

import json
import sqlite3
from pathlib import Path

import pytest

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
