"""`runglight import` and `runglight export`."""

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
