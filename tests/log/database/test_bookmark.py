"""Bookmarks: every time comes back as it was, and a damaged one is told."""

import json
from collections.abc import Callable
from datetime import UTC, date, datetime
from decimal import Decimal
from pathlib import Path
from typing import Any

import msgspec
import pytest

import runglight as rl
from runglight.log.database.bookmark import Bookmark, RowsById, RowsByTime, StoredTime, mark_of
from runglight.log.database.time_scale import seconds
from tests.log.database.filling import kepserverex, made, paper_003

TIMES: list[Any] = [
    "2026-01-05 06:00:00.5",
    1767592800500,
    1767592800.1234567,
    Decimal("1767592800.500"),
    datetime(2026, 1, 5, 6, 0, 0, 123456),
    datetime(2026, 1, 5, 6, tzinfo=UTC),
    date(2026, 1, 5),
]


@pytest.mark.parametrize("time", TIMES, ids=repr)
def test_times_come_back(time: Any) -> None:
    written = msgspec.json.encode(RowsByTime(StoredTime.of(time), ["a"]))
    read = msgspec.json.decode(written, type=Bookmark)
    assert isinstance(read, RowsByTime)
    assert read.since is not None
    assert read.since.value() == time
    assert type(read.since.value()) is type(time)


@pytest.mark.parametrize("nothing", [None, True, b"x"])
def test_what_is_no_time(nothing: Any) -> None:
    with pytest.raises(rl.InputError, match="expected a date, text or number"):
        StoredTime.of(nothing)


def test_marks_tell_cells_apart() -> None:
    assert mark_of([1, "a"]) == mark_of(["1", "a"]) != mark_of(["1a"])
    assert mark_of(["a", None]) != mark_of([None, "a"])


@pytest.mark.parametrize(
    ("time", "time_format", "expected_s"),
    [
        (1767592800500, None, 1767592800.5),
        (1767592800500000, None, 1767592800.5),
        (1767592800500000000, None, 1767592800.5),
        (1767592800.5, None, 1767592800.5),
        (5000, "ms", 5.0),
        ("5000", "ms", 5.0),
        ("2026/01/05 06:00:00.5", None, 1767592800.5),
        ("2026-01-05T08:00:00.5+02:00", None, 1767592800.5),
        (datetime(2026, 1, 5, 6, 0, 0, 500000), None, 1767592800.5),
        ("soon", None, None),
        (b"", None, None),
    ],
)
def test_seconds(time: Any, time_format: str | None, expected_s: float | None) -> None:
    assert seconds(time, time_format) == (
        None if expected_s is None else pytest.approx(expected_s, abs=1e-6)
    )


def test_holes_come_back() -> None:
    bookmark = RowsById(9, "m", [(1, 3), (5, 5)])
    assert msgspec.convert(msgspec.to_builtins(bookmark), Bookmark) == bookmark


def test_a_damaged_bookmark(tmp_path: Path, refused: Callable[..., str], runglight: Any) -> None:
    url = f"sqlite:///{tmp_path}/plant.db"
    (tmp_path / "plant.db").touch()
    row = {"Date and time": "2026-01-05 06:00", "Variable name": "A", "Value": 1}
    made(url, paper_003(), [{"id": 1} | row])
    made(
        url,
        kepserverex(),
        [{"_NAME": "A", "_VALUE": "1", "_TIMESTAMP": "2026-01-05", "_QUALITY": 192}],
    )
    bookmarks = {}
    for table in ("history", "plant"):
        assert runglight("import", "--sql", url, "--table", table, "--to", table).returncode == 0
        manifest = json.loads((tmp_path / table / "imported.json").read_text(encoding="utf-8"))
        bookmarks[table] = manifest["bookmark"]
    assert (bookmarks["history"]["by"], bookmarks["plant"]["by"]) == ("id", "time")
    damages: list[tuple[str, Any, str]] = [
        ("history", {"by": "id"}, "its bookmark: Object missing required field"),
        ("history", {"by": "chance"}, "its bookmark: Invalid value 'chance'"),
        ("history", bookmarks["plant"], "its bookmark is a time, not an id"),
        ("plant", bookmarks["history"], "its bookmark is an id, not a time"),
        (
            "plant",
            {"by": "time", "since": {"kind": "integer", "text": "x"}, "seen": []},
            "its bookmark: invalid literal",
        ),
    ]
    for table, bookmark, sentence in damages:
        path = tmp_path / table / "imported.json"
        manifest = json.loads(path.read_text(encoding="utf-8"))
        path.write_text(json.dumps(manifest | {"bookmark": bookmark}), encoding="utf-8")
        line = refused("import", "--sql", url, "--table", table, "--to", table)
        assert f"imported.json: is damaged ({sentence}" in line
