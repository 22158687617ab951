"""Logs in tables of real databases: SQLite files, and PostgreSQL where it can be started."""

import os
import sqlite3
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

import runglight as rl
from runglight.log.database import columns, quality, single_table
from runglight.log.database import url as database_url_module
from tests.conftest import Command, simulated

pytest.importorskip("sqlalchemy")

Refused = Callable[..., str]

PAPER_003 = (
    "CREATE TABLE history "
    '("id" INTEGER PRIMARY KEY, "Date and time" TEXT, "Variable name" TEXT, "Value" {})'
)
KEPSERVEREX = (
    "CREATE TABLE plant "
    "(_NAME TEXT, _NUMERICID INTEGER, _VALUE TEXT, _TIMESTAMP TIMESTAMP, _QUALITY INTEGER)"
)


def stored(path: Path, statement: str, rows: Sequence[Sequence[object]]) -> str:
    """Makes a table with these rows; returns the URL of its database."""
    connection = sqlite3.connect(path)
    with connection:
        connection.execute(statement)
        table = statement.split()[2]
        for row in rows:
            marks = ", ".join("?" * len(row))
            connection.execute(f"INSERT INTO {table} VALUES ({marks})", row)
    connection.close()
    return f"sqlite:///{path}"


def history(path: Path, rows: Sequence[Sequence[object]], value: str = "INTEGER") -> str:
    """The table of paper 003."""
    return stored(path, PAPER_003.format(value), rows)


@pytest.fixture
def plant(tmp_path: Path) -> str:
    """A KEPServerEX DataLogger table whose rows came in no order."""
    times = [f"2026-01-05 06:00:0{second}.250" for second in range(4)]
    rows = [
        ("Line1-Clamp-OPEN", 7, "0", times[2], 192),
        ("Line1-Clamp-OPEN", 7, "1", times[0], 192),
        ("Line1-Clamp-CLOSED", 8, "True", times[3], 192),
        ("Line1-Clamp-CLOSED", 8, "0", times[1], 24),
        ("Line1-Clamp-CLOSED", 8, "0", times[1], None),
    ]
    return stored(tmp_path / "plant.db", KEPSERVEREX, rows)


def rows_of(log: rl.Log) -> list[tuple[str, int]]:
    _, signal, value = log.columns()
    return [(log.signals[index], int(number)) for index, number in zip(signal, value, strict=True)]


def test_the_table_of_paper_003(tmp_path: Path) -> None:
    url = history(
        tmp_path / "history.db",
        [
            (4, "2026-01-05T06:00:01.02Z", "%M1", 0),
            (3, "2026-01-05T06:00:00.01Z", "%M2", 1),
            (1, "2026-01-05T06:00:01.02Z", "%M2", 0),
            (2, "2026-01-05T06:00:00.01Z", "%M1", 1),
        ],
    )
    log = rl.read_log(sql=url, table="history")
    assert rows_of(log) == [("%M1", 1), ("%M2", 1), ("%M2", 0), ("%M1", 0)]
    assert str(log.start) == "2026-01-05 06:00:00.010000+00:00"
    assert log.path == f"table history of {url}"
    assert log.report.format == "sql"
    assert (log.report.rows, log.report.notes, log.report.left_out) == (4, [], [])


def test_the_table_of_kepserverex(plant: str) -> None:
    log = rl.read_log(sql=plant, table="PLANT")
    assert rows_of(log) == [
        ("Line1-Clamp-OPEN", 1),
        ("Line1-Clamp-OPEN", 0),
        ("Line1-Clamp-CLOSED", 1),
    ]
    said = log.report.sentences(str(log.path))
    assert "2 rows were skipped, because _QUALITY is not 192 (good)" in said[-1]
    assert any("left out _NUMERICID: " in sentence for sentence in said)
    assert any("times without a zone are read as UTC" in sentence for sentence in said)
    assert any("it has no id" in sentence for sentence in said)
    assert log.slice(1).renamed(["A", "B"]).report == log.report


def test_a_quality_that_is_asked_for_is_no_filter(plant: str) -> None:
    log = rl.read_log(sql=plant, table="plant", value_column="_quality", on_error="skip")
    assert {value for _, value in rows_of(log)} == {192, 24}


def test_columns_by_option(tmp_path: Path) -> None:
    url = stored(
        tmp_path / "odd.db",
        "CREATE TABLE odd (ID INTEGER PRIMARY KEY, moment REAL, line TEXT, part TEXT, reading INT)",
        [(1, 1767592801.5, "A", "X", 0), (2, 1767592800.25, "A", "X", 1)],
    )
    log = rl.read_log(
        sql=url,
        table="odd",
        time_column="Moment",
        signal_columns=["line", "part"],
        value_column="reading",
    )
    assert rows_of(log) == [("A-X", 1), ("A-X", 0)]


@pytest.mark.parametrize(
    "times",
    [
        ["23:59:59.5", "00:00:00.5"],
        ["31.01.2026 23:59:59", "01.02.2026 00:00:00"],
    ],
)
def test_times_that_do_not_sort_are_read_by_id(tmp_path: Path, times: list[str]) -> None:
    url = history(tmp_path / "h.db", [(1, times[0], "A", 1), (2, times[1], "A", 0)])
    log = rl.read_log(sql=url, table="history")
    assert rows_of(log) == [("A", 1), ("A", 0)]
    assert log.end is not None
    assert log.start is not None
    assert (log.end - log.start).total_seconds() == 1


def test_a_date_and_a_time_of_day(tmp_path: Path) -> None:
    url = stored(
        tmp_path / "split.db",
        "CREATE TABLE split (date TEXT, time TEXT, tag TEXT, value INTEGER)",
        [("2026-01-06", "00:00:01", "A", 0), ("2026-01-05", "23:59:59", "A", 1)],
    )
    log = rl.read_log(sql=url, table="split")
    assert rows_of(log) == [("A", 1), ("A", 0)]
    assert (str(log.start), str(log.end)) == (
        "2026-01-05 23:59:59+00:00",
        "2026-01-06 00:00:01+00:00",
    )


def test_a_table_of_samples(tmp_path: Path) -> None:
    url = stored(
        tmp_path / "wide.db",
        "CREATE TABLE wide (id INTEGER, time TEXT, VALVE INTEGER, PRESSURE REAL)",
        [(n, f"2026-01-05T06:00:{n:02}Z", n // 5 % 2, n + 0.5) for n in range(20)],
    )
    log = rl.read_log(sql=url, table="wide", analog={"PRESSURE": 10})
    assert sorted(set(rows_of(log))) == [
        *[("PRESSURE", 0), ("PRESSURE", 1)],
        *[("VALVE", 0), ("VALVE", 1)],
    ]


def test_many_partitions_equal_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(single_table, "ROWS_AT_ONCE", 7)
    log = simulated(cycles=2)
    log.write(tmp_path / "log.csv")
    lines = (tmp_path / "log.csv").read_text(encoding="utf-8").splitlines()[1:]
    rows = [(number, *line.split(",")) for number, line in enumerate(lines)]
    url = history(tmp_path / "log.db", rows[::-1])
    assert len(rows) > 7 * 3
    again = rl.read_log(sql=url, table="history")
    again.write(tmp_path / "again.csv")
    assert (tmp_path / "again.csv").read_bytes() == (tmp_path / "log.csv").read_bytes()


def test_what_is_no_log_is_said_before_all_is_fetched(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(single_table, "ROWS_AT_ONCE", 2)
    fetched = []

    def good(quality: object) -> bool:
        fetched.append(quality)
        return True

    monkeypatch.setattr(quality, "good", good)
    url = stored(
        tmp_path / "no.db",
        "CREATE TABLE recipes (title TEXT, author TEXT, _quality INTEGER)",
        [("a", "b", number) for number in range(10)],
    )
    with pytest.raises(rl.InputError, match="no time column found"):
        rl.read_log(sql=url, table="recipes")
    assert 2 <= len(fetched) < 10


def test_text_is_kept_and_bytes_are_text(tmp_path: Path) -> None:
    url = history(
        tmp_path / "h.db",
        [
            (1, "2026-01-05T06:00:00Z", 'Vanne "é", 1', "1"),
            (2, b"2026-01-05T06:00:01Z", b"A", b"0"),
        ],
        value="BLOB",
    )
    assert rows_of(rl.read_log(sql=url, table="history")) == [('Vanne "é", 1', 1), ("A", 0)]


def test_an_empty_table_is_an_empty_log(tmp_path: Path) -> None:
    log = rl.read_log(sql=history(tmp_path / "h.db", []), table="history")
    assert len(log) == 0
    assert "the table has no rows" in log.report.notes


def test_bad_rows_are_counted_from_the_first_row_of_the_table(tmp_path: Path) -> None:
    url = history(
        tmp_path / "h.db",
        [(1, "2026-01-05T06:00:00Z", "A", 1), (2, "2026-01-05T06:00:01Z", "A", "ajar")],
    )
    with pytest.raises(rl.InputError) as raised:
        rl.read_log(sql=url, table="history")
    assert str(raised.value).startswith(f"table history of {url}: row 2: column 'Value' is 'ajar'")
    assert "table.csv" not in str(raised.value)
    report = rl.read_log(sql=url, table="history", on_error="skip").report
    assert [(bad.row, "'ajar'" in bad.reason) for bad in report.bad] == [(2, True)]


@pytest.mark.parametrize(
    ("statement", "sentence"),
    [
        ("CREATE TABLE t (id INTEGER, tag TEXT, note TEXT)", "no time column found"),
        ("CREATE TABLE t (id INTEGER, time TEXT)", "no signal column found"),
        ("CREATE TABLE t (id INTEGER, time TEXT, tag TEXT, note TEXT)", "value column"),
    ],
)
def test_missing_columns(tmp_path: Path, statement: str, sentence: str) -> None:
    count = statement.count(",") + 1
    row = [1, "2026-01-05T06:00:00Z" if "time" in statement else "one", "one", "two"][:count]
    url = stored(tmp_path / "t.db", statement, [row])
    with pytest.raises(rl.InputError) as raised:
        rl.read_log(sql=url, table="t")
    assert str(raised.value).startswith(f"table t of {url}: no ")
    assert sentence in str(raised.value)


def test_an_unknown_column(plant: str) -> None:
    with pytest.raises(rl.InputError, match=r"of sqlite.*has no column 'when' \(option time_col"):
        rl.read_log(sql=plant, table="plant", time_column="when")


@pytest.mark.parametrize("options", [{}, {"table": "plant"}])
def test_python_needs_a_path_or_a_table(options: dict[str, str]) -> None:
    with pytest.raises(rl.InputError, match="give either the path of a file, or sql and table"):
        rl.read_log(**options)
    with pytest.raises(rl.InputError, match="give either"):
        rl.read_log("log.csv", sql="sqlite:///plant.db", **options)


@pytest.mark.parametrize(
    ("asked", "sentence"),
    [
        (["--table", "plnt"], "there is no table 'plnt' (did you mean plant?)"),
        (["--table", "main.plnt"], "there is no table 'main.plnt' (did you mean main.plant?)"),
        (["--table", "xyz"], "there is no table 'xyz'; there is plant"),
        ([], "which table? give --table; there is plant"),
    ],
)
def test_an_unknown_table(refused: Refused, plant: str, asked: list[str], sentence: str) -> None:
    line = refused("import", "--sql", plant, *asked, "--to", "out.csv")
    assert line == f"runglight: {plant}: {sentence}"


def test_a_table_of_a_schema_and_a_view(plant: str, tmp_path: Path) -> None:
    assert len(rl.read_log(sql=plant, table="main.Plant")) == 3
    connection = sqlite3.connect(tmp_path / "plant.db")
    connection.execute("CREATE VIEW opened AS SELECT * FROM plant WHERE _NUMERICID = 7")
    connection.close()
    assert rl.read_log(sql=plant, table="opened").signals == ["Line1-Clamp-OPEN"]


@pytest.mark.parametrize(
    ("url", "sentence"),
    [
        ("plant.db", "--sql: this is no database URL; write it like sqlite:///plant.db"),
        ("hidden@plant", "--sql: this is no database URL"),
        ("postgresql://joe:hidden@host:port/db", "--sql: this is no database URL"),
        ("postgres://joe:hidden@host/db", "known as 'postgres' (did you mean postgresql?)"),
        ("carrier-pigeon://joe:hidden@host/db", "write it like sqlite:///plant.db"),
        ("sqlite:///missing.db", "missing.db: there is no such SQLite file"),
        ("sqlite://", "there is no table 'plant'; the database has none"),
        (
            "sqlite:///plant.db?timeout=soon",
            "sqlite:///plant.db: cannot connect: could not convert",
        ),
    ],
)
def test_a_bad_url(refused: Refused, plant: str, tmp_path: Path, url: str, sentence: str) -> None:
    assert plant
    line = refused("import", "--sql", url, "--table", "plant", "--to", "out.csv")
    assert sentence in line
    assert "hidden" not in line
    assert sorted(path.name for path in tmp_path.iterdir()) == ["plant.db"]


def test_a_file_that_is_no_database(refused: Refused, tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text("time,signal,value\n" * 100, encoding="utf-8")
    line = refused("import", "--sql", "sqlite:///log.csv", "--table", "log", "--to", "out.csv")
    assert "sqlite:///log.csv: cannot read: file is not a database" in line


def test_an_unreachable_server(refused: Refused) -> None:
    pytest.importorskip("psycopg")
    url = "postgresql://joe:hidden@127.0.0.1:1/plant?application_name=hidden"
    line = refused("import", "--sql", url, "--table", "t", "--to", "out.csv")
    assert "postgresql+psycopg://joe:***@127.0.0.1:1/plant: cannot connect: " in line
    assert "refused" in line
    assert "hidden" not in line


def test_secrets_in_what_a_driver_says() -> None:
    url = database_url_module.make_url(
        "mssql+pyodbc://joe:one@host/db?odbc_connect=UID%3Djoe%3BPWD%3Dtwo%3B"
    )
    assert database_url_module.reason(ValueError("one of PWD=two;\n is wrong."), url) == (
        "*** of PWD=***; is wrong"
    )


@pytest.fixture
def without(tmp_path: Path) -> Callable[[str], dict[str, str]]:
    """The environment of a Python in which a module is not installed."""

    def environment(module: str) -> dict[str, str]:
        (tmp_path / "without").mkdir()
        (tmp_path / "without" / f"{module}.py").write_text(
            f"raise ModuleNotFoundError('not installed', name='{module}')\n", encoding="utf-8"
        )
        inherited = os.environ.get("PYTHONPATH", "")
        return {"PYTHONPATH": os.pathsep.join([str(tmp_path / "without"), inherited])}

    return environment


def test_without_sqlalchemy(
    refused: Refused, plant: str, without: Callable[[str], dict[str, str]]
) -> None:
    line = refused(
        *["import", "--sql", plant, "--table", "plant", "--to", "out.csv"],
        environment=without("sqlalchemy"),
    )
    assert line == (
        'runglight: reading from a database needs SQLAlchemy: pip install "runglight[sql]"'
    )


@pytest.mark.parametrize(
    ("scheme", "used", "driver", "package"),
    [
        ("postgresql", "postgresql+psycopg", "psycopg", '"psycopg[binary]"'),
        ("mysql", "mysql+pymysql", "pymysql", "PyMySQL"),
        ("mssql+pyodbc", "mssql+pyodbc", "pyodbc", "pyodbc"),
    ],
)
def test_without_a_driver(
    refused: Refused,
    without: Callable[[str], dict[str, str]],
    scheme: str,
    used: str,
    driver: str,
    package: str,
) -> None:
    line = refused(
        *["import", "--sql", f"{scheme}://joe:hidden@host/db", "--table", "t", "--to", "out.csv"],
        environment=without(driver),
    )
    assert line == (
        f"runglight: {used}://joe:***@host/db: its driver {driver} is not installed: "
        f"pip install {package}"
    )


def test_times_are_named_as_in_files() -> None:
    layout = Path(__file__).parents[3] / "crates" / "formats" / "src" / "layout.rs"
    names = layout.read_text(encoding="utf-8").partition("const TIME_NAMES")[2]
    listed = names.partition("= [")[2].partition("]")[0]
    assert [name.strip().strip('"') for name in listed.split(",") if name.strip()] == list(
        columns.TIME_NAMES
    )


def test_postgresql(postgresql: str, runglight: Command, refused: Refused, tmp_path: Path) -> None:
    psycopg = pytest.importorskip("psycopg")
    with psycopg.connect(postgresql) as connection:
        connection.execute(
            'CREATE SCHEMA "Plant"; CREATE TABLE "Plant"."Events" ('
            '"_NAME" text, "_NUMERICID" int, "_VALUE" boolean, "_TIMESTAMP" timestamptz,'
            ' "_QUALITY" smallint, id bigserial);'
            'INSERT INTO "Plant"."Events" SELECT \'A-B-\' || n % 3, n % 3, n % 2 = 0,'
            " timestamptz '2026-01-05 06:00:00+00' + (60001 - n) / 4 * interval '0.01 s',"
            " CASE WHEN n % 1000 = 0 THEN 0 ELSE 192 END FROM generate_series(1, 60000) n"
        )
    table = ["--sql", postgresql, "--table", "plant.events"]
    read = runglight("import", *table, "--to", "out.csv")
    assert read.returncode == 0, read.stderr
    assert "out.csv: 59,940 rows of 3 signals" in read.stdout
    assert "60 rows were skipped, because _QUALITY is not 192 (good)" in read.stderr
    assert "hidden" not in read.stdout + read.stderr
    lines = (tmp_path / "out.csv").read_text(encoding="utf-8").splitlines()
    # Rows of one time in the order of their ids: n = 59998, 59999 (60000 is not good).
    assert lines[1:3] == [
        "2026-01-05T06:00:00Z,A-B-1,1",
        "2026-01-05T06:00:00Z,A-B-2,0",
    ]
    assert "there is no table 'events'" in refused(
        "import", "--sql", postgresql, "--table", "events", "--to", "out.csv"
    )
