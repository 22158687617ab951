"""`runglight import` and `runglight export`."""

import sqlite3
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import Command


@pytest.mark.parametrize("ending", ["csv", "parquet", "xes", "vcd"])
def test_there_and_back(runglight: Command, cell: Path, tmp_path: Path, ending: str) -> None:
    there = runglight("export", cell / "nominal.csv", "--to", f"cell.{ending}")
    assert there.returncode == 0, there.stderr
    back = runglight("import", f"cell.{ending}", "--to", "back.csv")
    assert back.returncode == 0, back.stderr
    runglight("import", cell / "nominal.csv", "--to", "straight.csv")
    assert (tmp_path / "back.csv").read_text() == (tmp_path / "straight.csv").read_text()


def test_skipped_rows_are_shown(runglight: Command, tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text(
        "time,signal,value\n2026-01-01T00:00:00Z,A-B-C,1\nyesterday,A-B-C,0\n"
        "2026-01-01T00:00:02Z,A-B-C,0\n",
        encoding="utf-8",
    )
    assert runglight("import", "log.csv", "--to", "out.csv").returncode == 2
    skipped = runglight("import", "log.csv", "--to", "out.csv", "--on-error", "skip")
    assert skipped.returncode == 0, skipped.stderr
    assert "note: log.csv: 1 row skipped (row 3: " in skipped.stderr
    assert "2 rows" in skipped.stdout


def test_symbols_rename_addresses(runglight: Command, tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text(
        "time;signal;value\n2026-01-01T00:00:00Z;%IX0.0;1\n2026-01-01T00:00:01Z;%IX0.0;0\n",
        encoding="utf-8",
    )
    (tmp_path / "symbols.csv").write_text(
        "address,group,device,signal\n%IX0.0,Cell,Loader,HOME\n", encoding="utf-8"
    )
    named = runglight("import", "log.csv", "--to", "out.csv", "--symbols", "symbols.csv")
    assert named.returncode == 0, named.stderr
    assert (tmp_path / "out.csv").read_text(encoding="utf-8").count("Cell-Loader-HOME") == 2


def test_options_reach_the_reader(runglight: Command, tmp_path: Path) -> None:
    (tmp_path / "odd.txt").write_text(
        "when|line|part|state\n01.02.2026 06:00:00|A|X|1\n01.02.2026 06:00:01|A|X|0\n",
        encoding="utf-8",
    )
    read = runglight(
        *["import", "odd.txt", "--to", "out.csv", "--time-column", "when", "--delimiter", "|"],
        *["--signal-column", "line,part", "--value-column", "state"],
        *["--time-format", "%d.%m.%Y %H:%M:%S"],
    )
    assert read.returncode == 0, read.stderr
    assert "A-X" in (tmp_path / "out.csv").read_text(encoding="utf-8")


def test_analog_columns_are_banded(runglight: Command, tmp_path: Path) -> None:
    rows = "".join(f"2026-01-01T00:00:{s:02}Z,{s % 2},{s * 1.5}\n" for s in range(40))
    (tmp_path / "wide.csv").write_text("time,VALVE,LEVEL\n" + rows, encoding="utf-8")
    left_out = runglight("import", "wide.csv", "--to", "out.csv")
    assert left_out.returncode == 0, left_out.stderr
    assert "LEVEL" in left_out.stderr
    assert "LEVEL" not in (tmp_path / "out.csv").read_text(encoding="utf-8")
    banded = runglight("import", "wide.csv", "--to", "out.csv", "--analog", "LEVEL=20,40")
    assert banded.returncode == 0, banded.stderr
    levels = [
        line.rsplit(",", 1)[1]
        for line in (tmp_path / "out.csv").read_text(encoding="utf-8").splitlines()
        if "LEVEL" in line
    ]
    assert levels == ["0", "1", "2"]


@pytest.fixture
def database(cell: Path, tmp_path: Path) -> list[str]:
    """The options that name a table with the rows of `nominal.csv`."""
    pytest.importorskip("sqlalchemy")
    lines = (cell / "nominal.csv").read_text(encoding="utf-8").splitlines()
    connection = sqlite3.connect(tmp_path / "plant.db")
    with connection:
        connection.execute("CREATE TABLE cell (id INTEGER PRIMARY KEY, Timestamp, Tag, Value)")
        connection.executemany(
            "INSERT INTO cell (Timestamp, Tag, Value) VALUES (?, ?, ?)",
            [line.split(",") for line in lines[1:]],
        )
    connection.close()
    return ["--sql", "sqlite:///plant.db", "--table", "cell"]


@pytest.mark.parametrize("command", ["import", "export"])
def test_a_table_of_a_database(
    runglight: Command, cell: Path, tmp_path: Path, database: list[str], command: str
) -> None:
    read = runglight(command, *database, "--to", "out.csv")
    assert read.returncode == 0, read.stderr
    assert (tmp_path / "out.csv").read_bytes() == (cell / "nominal.csv").read_bytes()


def test_every_command_that_takes_a_log_takes_a_table(
    runglight: Command, cell: Path, tmp_path: Path, database: list[str]
) -> None:
    symbols = ["--symbols", cell / "symbols.csv"]
    learned = runglight("learn", *database, *symbols, "-o", "cell.model")
    assert learned.returncode == 0, learned.stderr
    runglight("learn", cell / "nominal.csv", *symbols, "-o", "file.model")
    for model in ("cell.model", "file.model"):
        runglight("show", model, "--format", "csv", "-o", f"{model}.csv")
    rules = (tmp_path / "cell.model.csv").read_bytes()
    assert rules.count(b"\n") > 50
    assert rules == (tmp_path / "file.model.csv").read_bytes()
    watched = runglight("watch", "cell.model", *database)
    assert watched.stdout.startswith("No findings"), watched.stderr
    injected = runglight("simulate", "faults", *database, "--faults", "1", "--to", "faulty.csv")
    assert injected.returncode == 0, injected.stderr


def test_a_table_in_the_configuration(
    runglight: Command, cell: Path, tmp_path: Path, database: list[str]
) -> None:
    (tmp_path / "plant").mkdir()
    (tmp_path / "plant.db").rename(tmp_path / "plant" / "cell.db")
    (tmp_path / "plant" / "machine.toml").write_text(
        "[log]\nsql = 'sqlite:///cell.db'\ntable = 'cell'\n", encoding="utf-8"
    )
    read = runglight("import", "-c", "plant/machine.toml", "--to", "out.csv")
    assert read.returncode == 0, read.stderr
    # A log that is named comes before the table of the file.
    named = runglight("import", cell / "faulty.csv", "-c", "plant/machine.toml", "--to", "f.csv")
    assert named.returncode == 0, named.stderr
    assert (tmp_path / "f.csv").read_bytes() == (cell / "faulty.csv").read_bytes()
    watched = runglight("watch", cell / "cell.model", "-c", "plant/machine.toml")
    assert watched.stdout.startswith("No findings"), watched.stderr


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ([], "what shall be read? name a log, or a table with --sql URL --table T"),
        (["--table", "cell"], "--table: say with --sql in which database it is"),
        (["log.csv", "--table", "cell"], "log.csv: leave it out where --sql and --table say"),
        (["log.csv", "--sql", "sqlite:///plant.db"], "log.csv: leave it out"),
    ],
)
def test_a_log_or_a_table(refused: Callable[..., str], arguments: list[str], sentence: str) -> None:
    assert sentence in refused("import", *arguments, "--to", "out.csv")
