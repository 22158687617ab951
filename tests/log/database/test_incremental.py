"""Imports piece by piece: nothing doubled, nothing lost."""

import json
import os
import random
import shutil
import signal
import sqlite3
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Sequence
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sqlalchemy import DateTime, Table, create_engine, delete, insert, text

import runglight as rl
from runglight.log import imported
from runglight.log.database import by_id, incremental
from runglight.log.database.incremental import directory_for, import_new
from runglight.log.database.url import database_url
from runglight.log.imported import directory as import_directory
from runglight.log.options import ReadOptions
from tests.conftest import Command, simulated
from tests.log.database.filling import add, kepserverex, made, paper_003, writing

START = datetime(2026, 1, 5, 6)
Refused = Callable[..., str]
Moment = float


def numbered(seconds: Sequence[Moment], first: int = 1) -> list[dict[str, Any]]:
    """Rows of paper 003 at these seconds; the value tells the row."""
    return [
        {
            "id": first + position,
            "Date and time": (START + timedelta(seconds=second)).isoformat(" ", "microseconds"),
            "Variable name": f"S{(first + position) % 3}",
            "Value": first + position,
        }
        for position, second in enumerate(seconds)
    ]


def unnumbered(seconds: Sequence[Moment], first: int = 1) -> list[dict[str, Any]]:
    """Rows of KEPServerEX at these seconds."""
    return [
        {
            "_NAME": row["Variable name"],
            "_NUMERICID": row["id"] % 3,
            "_VALUE": str(row["Value"]),
            "_TIMESTAMP": row["Date and time"],
            "_QUALITY": 192,
        }
        for row in numbered(seconds, first)
    ]


def taken(url: str, table: str, path: Path, **options: Any) -> int:
    """Imports what is new; returns the number of rows."""
    reading = ReadOptions(sql=url, table=str(table), **options)
    with directory_for(reading, path) as directory:
        before = directory.rows
        for _ in import_new(reading, directory):
            pass
        return directory.rows - before


def values(path: Path) -> list[int]:
    return [int(value) for value in rl.read_log(path).columns()[2]]


SHAPES = [(paper_003, numbered), (kepserverex, unnumbered)]


@pytest.fixture(params=SHAPES, ids=["paper_003", "kepserverex"])
def shape(
    request: pytest.FixtureRequest,
) -> tuple[Table, Callable[..., list[dict[str, Any]]]]:
    make, rows = request.param
    return make(), rows


def test_only_what_is_new(database: str, shape: Any, tmp_path: Path) -> None:
    table, rows = shape
    made(database, table, rows([n / 10 for n in range(50)]))
    path = tmp_path / "plant"
    assert taken(database, table.name, path) == 50
    assert taken(database, table.name, path) == 0
    add(database, table, rows([5 + n / 10 for n in range(7)], first=51))
    assert taken(database, table.name, path) == 7
    assert values(path) == list(range(1, 58))
    log = rl.read_log(path)
    assert log.report.format == "imported"
    assert len(list(path.glob("*.parquet"))) == 1


def test_any_split_gives_the_whole(
    database: str, shape: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    table, rows = shape
    # Seven rows at each time, so that pages end within one; never more than a second at once.
    made(database, table, rows([n // 7 * 0.3 for n in range(100)]))
    for size in (1, 3, 8, 60):
        monkeypatch.setattr(incremental, "ROWS_AT_ONCE", size)
        monkeypatch.setattr(import_directory, "SEGMENT_ROWS", 20)
        path = tmp_path / f"by{size}"
        assert taken(database, table.name, path) == 100
        assert sorted(values(path)) == list(range(1, 101))
        assert len(list(path.glob("*.parquet"))) > 1


def test_late_rows_are_sorted_in(database: str, shape: Any, tmp_path: Path) -> None:
    table, rows = shape
    made(database, table, rows([0, 1, 2, 3]))
    path = tmp_path / "plant"
    assert taken(database, table.name, path) == 4
    add(database, table, rows([2.5, 3.5, 2.25], first=5))
    assert taken(database, table.name, path, reorder_s=2) == 3
    assert values(path) == [1, 2, 3, 7, 5, 4, 6]
    assert taken(database, table.name, path, reorder_s=2) == 0


def test_rows_that_are_the_same_are_counted(database: str, tmp_path: Path) -> None:
    table = kepserverex()
    [row] = unnumbered([0])
    made(database, table, [row, row])
    path = tmp_path / "plant"
    assert taken(database, "plant", path) == 2
    add(database, table, [row])
    assert taken(database, "plant", path) == 1
    assert taken(database, "plant", path) == 0
    assert len(rl.read_log(path)) == 3


def test_rows_that_are_too_late(database: str, tmp_path: Path) -> None:
    made(database, paper_003(), numbered([0, 10]))
    path = tmp_path / "plant"
    assert taken(database, "history", path) == 2
    add(database, paper_003(), numbered([1, 11], first=3))
    with pytest.raises(rl.InputError, match=r"S0 at 2026-01-05 06:00:01.* lies 9\.000 s before"):
        taken(database, "history", path)
    assert values(path) == [1, 2]
    assert taken(database, "history", path, on_error="skip") == 1
    assert values(path) == [1, 2, 4]
    assert rl.read_log(path).report.notes == ["1 row was left out when it was imported"]


def test_ids_of_transactions_that_end_late(database: str, tmp_path: Path) -> None:
    rows = numbered([n / 100 for n in range(12)])
    path = tmp_path / "plant"
    made(database, paper_003(), [row for row in rows if row["id"] not in {1, 5, 6, 7, 9}])
    assert taken(database, "history", path) == 7
    for number in (6, 1, 9, 5):
        add(database, paper_003(), [rows[number - 1]])
        assert taken(database, "history", path) == 1
    assert values(path) == [1, 2, 3, 4, 5, 6, 8, 9, 10, 11, 12]


def test_holes_are_bounded(database: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(by_id, "HOLES", 3)
    made(database, paper_003(), [row for row in numbered([0] * 100) if row["id"] % 10 == 0])
    assert taken(database, "history", tmp_path / "plant") == 10
    bookmark = json.loads((tmp_path / "plant" / "imported.json").read_text())["bookmark"]
    assert bookmark["holes"] == [[71, 79], [81, 89], [91, 99]]


def test_a_bad_row_ends_it_and_what_was_before_stays(
    database: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(incremental, "ROWS_AT_ONCE", 4)
    rows = numbered([n / 10 for n in range(10)])
    rows[6]["Variable name"] = None
    made(database, paper_003(), rows)
    path = tmp_path / "plant"
    with pytest.raises(rl.InputError, match=r"is empty.*\[id 7\]"):
        taken(database, "history", path)
    assert values(path) == [1, 2, 3, 4]
    assert taken(database, "history", path, on_error="skip") == 5
    assert values(path) == [1, 2, 3, 4, 5, 6, 8, 9, 10]


@pytest.mark.parametrize("again", [0, 2, 9])
def test_a_table_that_was_made_anew(database: str, shape: Any, tmp_path: Path, again: int) -> None:
    table, rows = shape
    made(database, table, rows([0, 1, 2, 3]))
    path = tmp_path / "plant"
    assert taken(database, table.name, path) == 4
    with writing(database) as connection:
        connection.execute(delete(table))
    add(database, table, rows([100 + n for n in range(again)], first=1))
    with pytest.raises(rl.InputError, match="was emptied or made anew since the last import"):
        taken(database, table.name, path)
    assert len(rl.read_log(path)) == 4


def test_times_of_a_type_of_their_own(database: str, tmp_path: Path) -> None:
    table = kepserverex(DateTime())
    rows = [
        row | {"_TIMESTAMP": START + timedelta(seconds=n)}
        for n, row in enumerate(unnumbered([0] * 20))
    ]
    made(database, table, rows[:10])
    path = tmp_path / "plant"
    assert taken(database, "plant", path) == 10
    add(database, table, rows[10:])
    assert taken(database, "plant", path) == 10
    assert values(path) == list(range(1, 21))


def test_rows_without_a_time(database: str, tmp_path: Path) -> None:
    rows = unnumbered([0, 1, 2])
    rows[1]["_TIMESTAMP"] = None
    made(database, kepserverex(), rows)
    path = tmp_path / "plant"
    with pytest.raises(rl.InputError, match="1 row has no time in column '_TIMESTAMP'"):
        taken(database, "plant", path)
    assert taken(database, "plant", path, on_error="skip") == 2
    assert rl.read_log(path).report.notes == ["1 row was left out when it was imported"]
    assert taken(database, "plant", path) == 0


def test_an_id_that_is_not_unique_is_not_gone_by(database: str, tmp_path: Path) -> None:
    with writing(database) as connection:
        connection.execute(
            text("CREATE TABLE tags (id INTEGER, time VARCHAR(40), tag VARCHAR(9), value INTEGER)")
        )
        for n in range(9):
            connection.execute(
                text(f"INSERT INTO tags VALUES ({n % 2}, '2026-01-05 06:00:0{n}', 'T{n % 2}', {n})")
            )
    assert taken(database, "tags", tmp_path / "plant") == 9
    assert taken(database, "tags", tmp_path / "plant") == 0


@pytest.mark.parametrize(
    ("statement", "row", "sentence"),
    [
        ("(id INTEGER PRIMARY KEY, time TEXT, A INT, B INT)", "1, '2026-01-05', 0, 1", "samples"),
        (
            "(id INTEGER PRIMARY KEY, time TEXT, tag TEXT, value INT)",
            "1, '06:00:00', 'A', 1",
            "times of day only",
        ),
        ("(time TEXT, tag TEXT, value INT)", "'31.01.2026 06:00:00', 'A', 1", "neither an id"),
    ],
)
def test_what_is_not_taken_piece_by_piece(
    tmp_path: Path, refused: Refused, statement: str, row: str, sentence: str
) -> None:
    url = f"sqlite:///{tmp_path}/plant.db"
    (tmp_path / "plant.db").touch()
    with writing(url) as connection:
        connection.execute(text(f"CREATE TABLE t {statement}"))
        connection.execute(text(f"INSERT INTO t VALUES ({row})"))
    line = refused("import", "--sql", url, "--table", "t", "--to", "plant")
    assert sentence in line
    assert "--to plant.parquet" in line


def test_no_password_is_kept(postgresql: str, tmp_path: Path, runglight: Command) -> None:
    made(postgresql, paper_003(name="kept"), numbered([0, 1]))
    ended = runglight("import", "--sql", postgresql, "--table", "kept", "--to", "plant")
    assert ended.returncode == 0, ended.stderr
    texts = [each.read_bytes() for each in (tmp_path / "plant").iterdir()]
    assert len(texts) == 2
    assert not any(b"hidden" in each for each in texts)


FOLLOWING = """
import sys
from pathlib import Path
from runglight.log.database import incremental
from runglight.log.imported import directory
incremental.ROWS_AT_ONCE, directory.SEGMENT_ROWS = 40, 200
from runglight.log.database.incremental import directory_for, import_new
from runglight.log.options import ReadOptions
options = ReadOptions(sql=sys.argv[1], table=sys.argv[2], reorder_s=2.0)
with directory_for(options, Path(sys.argv[3])) as into:
    print("ready", flush=True)
    while True:
        for _ in import_new(options, into):
            pass
"""


def test_killed_at_any_moment(database: str, shape: Any, tmp_path: Path) -> None:
    table, rows = shape
    made(database, table, rows([0]))
    path = tmp_path / "plant"
    chance = random.Random(4)
    engine = create_engine(
        database_url(database),
        connect_args={"timeout": 30} if database.startswith("sqlite") else {},
    )
    written = 1
    for _ in range(8):
        importing = subprocess.Popen(
            [sys.executable, "-c", FOLLOWING, database, str(table.name), str(path)],
            stdout=subprocess.PIPE,
            text=True,
        )
        assert importing.stdout is not None
        assert importing.stdout.readline() == "ready\n"
        end = time.monotonic() + chance.uniform(0.02, 0.5)
        while time.monotonic() < end:
            # Late ones among them.
            seconds = [(written + n) / 50 + chance.choice([0, -0.7]) for n in range(30)]
            with engine.begin() as connection:
                connection.execute(insert(table), rows(seconds, first=written + 1))
            written += 30
        importing.send_signal(signal.SIGKILL)
        # It was at work until now.
        assert importing.wait() == -signal.SIGKILL
        importing.stdout.close()
        if imported.is_imported(path):
            copy = tmp_path / "copy"
            shutil.copytree(path, copy)
            counted = Counter(values(copy))
            assert not counted or max(counted.values()) == 1
            shutil.rmtree(copy)
    engine.dispose()
    assert written > 100
    taken(database, table.name, path, reorder_s=2.0)
    assert sorted(values(path)) == list(range(1, written + 1))
    assert len(list(path.glob("*.parquet"))) == len(
        json.loads((path / "imported.json").read_text())["segments"]
    )


def test_following(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path}/plant.db"
    (tmp_path / "plant.db").touch()
    made(url, paper_003(), numbered([0]))
    following = subprocess.Popen(
        [
            sys.executable,
            "-m",
            "runglight",
            "import",
            "--sql",
            url,
            "--table",
            "history",
            "--to",
            "plant",
            "--follow",
            "--every",
            "20ms",
        ],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"CI": "true"},
    )
    assert following.stdout is not None
    assert following.stdout.readline() == "plant: 1 new rows, 1 in all\n"
    add(url, paper_003(), numbered([1, 2], first=2))
    assert following.stdout.readline() == "plant: 2 new rows, 3 in all\n"
    # Another import of the same directory is refused while this one runs.
    with pytest.raises(rl.InputError, match="another import is writing to it"):
        taken(url, "history", tmp_path / "plant")
    following.send_signal(signal.SIGTERM)
    rest, said = following.communicate(timeout=300)
    assert (following.returncode, rest) == (0, "")
    assert "Traceback" not in said
    assert values(tmp_path / "plant") == [1, 2, 3]


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["log.csv", "--to", "plant.csv", "--follow"], "--follow: takes a table piece by piece"),
        (["log.csv", "--to", "plant"], "cannot tell the format from the ending"),
        (["--sql", "sqlite:///p.db", "--table", "t", "--to", "d", "--every", "soon"], "--every: "),
        (
            ["--sql", "sqlite:///p.db", "--table", "t", "--to", "d", "--every", "0"],
            "at least 10 ms",
        ),
        (["--table", "t", "--to", "d"], "--table: say with --sql"),
        (["--sql", "sqlite:///p.db", "--table", "t", "--to", "d"], "no such SQLite file"),
    ],
)
def test_what_cannot_be(refused: Refused, arguments: list[str], sentence: str) -> None:
    assert sentence in refused("import", *arguments)


def test_a_database_that_is_away_for_a_while(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path}/plant.db?timeout=0.01"
    (tmp_path / "plant.db").touch()
    made(url, paper_003(), numbered([0]))
    following = subprocess.Popen(
        [
            *[sys.executable, "-m", "runglight", "import", "--sql", url, "--table", "history"],
            *["--to", "plant", "--follow", "--every", "20ms"],
        ],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"CI": "true"},
    )
    assert following.stdout is not None
    assert following.stderr is not None
    assert following.stdout.readline() == "plant: 1 new rows, 1 in all\n"
    assert "times without a zone" in following.stderr.readline()
    held = sqlite3.connect(tmp_path / "plant.db", isolation_level=None, timeout=60)
    held.execute("BEGIN EXCLUSIVE")
    assert "database is locked; trying again every 0.02 s" in following.stderr.readline()
    held.execute("INSERT INTO history VALUES (2, '2026-01-05 06:00:01', 'A', 2)")
    held.execute("COMMIT")
    held.close()
    assert following.stdout.readline() == "plant: 1 new rows, 2 in all\n"
    following.send_signal(signal.SIGTERM)
    rest, said = following.communicate(timeout=300)
    assert (following.returncode, rest, said) == (0, "", "")


def test_a_directory_is_learned_from(tmp_path: Path, runglight: Command) -> None:
    url = f"sqlite:///{tmp_path}/plant.db"
    (tmp_path / "plant.db").touch()
    log = simulated(cycles=4)
    time_ns, signal_index, value = log.columns()
    rows = [
        {
            "id": position + 1,
            "Date and time": str(np.datetime64(int(row[0]), "ns")),
            "Variable name": log.signals[int(row[1])],
            "Value": int(row[2]),
        }
        for position, row in enumerate(zip(time_ns, signal_index, value, strict=True))
    ]
    made(url, paper_003(), rows)
    table = ["--sql", url, "--table", "history"]
    assert runglight("import", *table, "--to", "plant").returncode == 0
    for source, model in (["plant"], "a.model"), (table, "b.model"):
        assert runglight("learn", *source, "-o", model).returncode == 0
    rules = [(tmp_path / model / "rules.parquet").read_bytes() for model in ("a.model", "b.model")]
    assert rules[0] == rules[1]
    watched = runglight("watch", "a.model", "plant")
    assert watched.returncode == 0, watched.stderr
