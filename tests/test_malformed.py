"""Malformed input: data, or one clear sentence. Never a traceback, never half a file."""

import gzip
import io
import struct
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from tests.conftest import Command

HEADER = "time,signal,value\n"
ROWS = "2026-01-01T00:00:00Z,A-B-C,1\n2026-01-01T00:00:01Z,A-B-C,0\n2026-01-01T00:00:02Z,A-B-D,1\n"


def parquet(table: pa.Table) -> bytes:
    sink = io.BytesIO()
    pq.write_table(table, sink)
    return sink.getvalue()


def changes(rows: int) -> pa.Table:
    return pa.table(
        {
            "time": pa.array([second * 10**9 for second in range(rows)], pa.timestamp("ns", "UTC")),
            "signal": [f"A-B-{row % 3}" for row in range(rows)],
            "value": [row % 2 for row in range(rows)],
        }
    )


def row(time: str, signal: str = "A-B-C", value: str = "1") -> str:
    return HEADER + ROWS + f"{time},{signal},{value}\n"


def zipped(name: str, content: bytes) -> bytes:
    sink = io.BytesIO()
    with zipfile.ZipFile(sink, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(name, content)
    return sink.getvalue()


BOMB = b"0" * (1 << 26)
JUNK = bytes((index * 7919 + index // 13) % 256 for index in range(4096))

MUST_BE_REFUSED: dict[str, tuple[str, bytes | str]] = {
    "empty": ("log.csv", b""),
    "only white space": ("log.csv", "\n \n\t\n"),
    "binary junk": ("log.csv", JUNK),
    "only NUL bytes": ("log.csv", b"\0" * 4096),
    "binary junk as Parquet": ("log.parquet", JUNK),
    "binary junk as XES": ("log.xes", JUNK),
    "binary junk as VCD": ("log.vcd", JUNK),
    "empty Parquet": ("log.parquet", b""),
    "truncated Parquet": ("log.parquet", parquet(changes(1000))[:-200]),
    "Parquet with a damaged page": (
        "log.parquet",
        parquet(changes(1000))[:20] + b"\xff" * 200 + parquet(changes(1000))[220:],
    ),
    "Parquet with a huge footer length": (
        "log.parquet",
        parquet(changes(10))[:-8] + struct.pack("<I", 0x7FFFFFFF) + b"PAR1",
    ),
    "Parquet without the columns": ("log.parquet", parquet(pa.table({"text": ["x"]}))),
    "truncated XES": ("log.xes", '<?xml version="1.0"?><log><trace><event><string key="a'),
    "XES that is no XES": ("log.xes", "<html><body>404 Not Found</body></html>"),
    "VCD without definitions": ("log.vcd", "#0\n1!\n#5\n0!\n"),
    "no header": ("log.csv", "this is not a log\nat all\n"),
    "header without a time": ("log.csv", "a,b,c\n1,2,3\n"),
    "time that is a word": ("log.csv", row("yesterday")),
    "time out of range": ("log.csv", row("2026-13-45T99:99:99Z")),
    "empty time": ("log.csv", row("")),
    "value that is a word": ("log.csv", row("2026-01-01T00:00:03Z", value="perhaps")),
    "NaN value": ("log.csv", row("2026-01-01T00:00:03Z", value="NaN")),
    "infinite value": ("log.csv", row("2026-01-01T00:00:03Z", value="inf")),
    "huge value": ("log.csv", row("2026-01-01T00:00:03Z", value="9" * 40)),
    "too few fields": ("log.csv", HEADER + ROWS + "2026-01-01T00:00:03Z,A-B-C\n"),
    "too many fields": ("log.csv", HEADER + ROWS + "2026-01-01T00:00:03Z,A-B-C,1,2,3\n"),
    "unsorted beyond the window": ("log.csv", row("2025-06-01T00:00:00Z")),
    "an open quote": ("log.csv", HEADER + ROWS + '2026-01-01T00:00:03Z,"A-B-C,1\n' + ROWS),
    "a zip archive": ("log.zip", zipped("log.csv", (HEADER + ROWS).encode())),
    "zip bomb": ("log.zip", zipped("log.csv", BOMB)),
    "zip bomb called CSV": ("log.csv", zipped("log.csv", BOMB)),
    "gzip bomb": ("log.csv.gz", gzip.compress(BOMB)),
    "gzip bomb called CSV": ("log.csv", gzip.compress(BOMB)),
    "a PDF": ("log.csv", b"%PDF-1.7\n" + JUNK),
    "an Excel file": ("log.xlsx", zipped("xl/workbook.xml", b"<workbook/>")),
    "one endless line": ("log.csv", b"x" * (1 << 24)),
}

DATA_OR_REFUSAL: dict[str, tuple[str, bytes | str]] = {
    "header only": ("log.csv", HEADER),
    "truncated row": ("log.csv", HEADER + ROWS[:-4]),
    "byte order mark": ("log.csv", b"\xef\xbb\xbf" + (HEADER + ROWS).encode()),
    "UTF-16": ("log.csv", (HEADER + ROWS).encode("utf-16")),
    "UTF-16 without a mark": ("log.csv", (HEADER + ROWS).encode("utf-16-le")),
    "Latin-1": ("log.csv", (HEADER + ROWS.replace("D", "Zähler")).encode("latin-1")),
    "semicolons": ("log.csv", (HEADER + ROWS).replace(",", ";")),
    "tabulators": ("log.csv", (HEADER + ROWS).replace(",", "\t")),
    "mixed delimiters": ("log.csv", HEADER + ROWS.replace(",", ";")),
    "Windows line ends": ("log.csv", (HEADER + ROWS).replace("\n", "\r\n")),
    "old Macintosh line ends": ("log.csv", (HEADER + ROWS).replace("\n", "\r")),
    "negative time": ("log.csv", HEADER + "-5,A-B-C,1\n-4,A-B-C,0\n"),
    "huge time": ("log.csv", HEADER + f"{10**30},A-B-C,1\n"),
    "year 9999": ("log.csv", row("9999-12-31T23:59:59Z")),
    "NaN time": ("log.csv", HEADER + "nan,A-B-C,1\n"),
    "time without zone": ("log.csv", (HEADER + ROWS).replace("Z,", ",")),
    "fractions of a value": ("log.csv", row("2026-01-01T00:00:03Z", value="0.5")),
    "slightly unsorted": ("log.csv", row("2026-01-01T00:00:01.500Z")),
    "duplicate rows": ("log.csv", HEADER + ROWS + ROWS.splitlines()[-1] + "\n"),
    "duplicate columns": ("log.csv", "time,X,X\n2026-01-01T00:00:00Z,1,0\n"),
    "empty signal": ("log.csv", row("2026-01-01T00:00:03Z", signal="")),
    "empty value": ("log.csv", row("2026-01-01T00:00:03Z", value="")),
    "a very long signal name": ("log.csv", row("2026-01-01T00:00:03Z", signal="X" * 100_000)),
    "line breaks in a name": ("log.csv", row("2026-01-01T00:00:03Z", signal='"A\nB"')),
    "control characters in a name": ("log.csv", row("2026-01-01T00:00:03Z", signal="A\x1b[2J")),
    "NUL in a row": ("log.csv", row("2026-01-01T00:00:03Z", signal="A\0B")),
    "blank lines": ("log.csv", HEADER + ROWS.replace("\n", "\n\n")),
    "Parquet without rows": ("log.parquet", parquet(changes(0))),
    "Parquet with nulls": (
        "log.parquet",
        parquet(pa.table({"time": [1, None], "signal": ["a", None], "value": [1, None]})),
    ),
    "Parquet called CSV": ("log.csv", parquet(changes(10))),
    "CSV called Parquet": ("log.parquet", HEADER + ROWS),
    "CSV called nothing": ("log", HEADER + ROWS),
    "XES without events": ("log.xes", '<?xml version="1.0"?><log></log>'),
    "XES with an entity bomb": (
        "log.xes",
        '<?xml version="1.0"?><!DOCTYPE x [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;">'
        '<!ENTITY c "&b;&b;&b;&b;">]><log><trace><event><string key="concept:name" value="&c;"/>'
        "</event></trace></log>",
    ),
    "VCD with unknown variables": (
        "log.vcd",
        "$timescale 1 ns $end\n$var wire 1 ! a $end\n$enddefinitions $end\n#0\n1!\n#5\n1?\n",
    ),
    "VCD that goes back in time": (
        "log.vcd",
        "$timescale 1 s $end\n$var wire 1 ! a $end\n$enddefinitions $end\n#9\n1!\n#2\n0!\n",
    ),
    "thousands of columns": (
        "log.csv",
        "time," + ",".join(f"S{n}" for n in range(5000)) + "\n"
        "2026-01-01T00:00:00Z," + ",".join("1" * 5000) + "\n",
    ),
}

CASES = [
    *((name, *case, True) for name, case in MUST_BE_REFUSED.items()),
    *((name, *case, False) for name, case in DATA_OR_REFUSAL.items()),
]


@pytest.mark.parametrize(("name", "file", "content", "must_fail"), CASES, ids=lambda v: str(v)[:40])
def test_data_or_one_sentence(
    runglight: Command,
    tmp_path: Path,
    name: str,
    file: str,
    content: bytes | str,
    must_fail: bool,
) -> None:
    path = tmp_path / file
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    ended = runglight("import", path, "--to", "out.csv")
    result = tmp_path / "out.csv"
    if ended.returncode == 0:
        assert not must_fail, f"{name} was read: {ended.stdout}{ended.stderr}"
        assert result.read_text(encoding="utf-8").splitlines()[0] == "time,signal,value"
        assert all(line.startswith("note: ") for line in ended.stderr.splitlines())
    else:
        assert ended.returncode == 2, ended
        assert_one_sentence(ended.stderr, file)
        assert not result.exists()


def assert_one_sentence(text: str, file: str) -> None:
    lines = text.splitlines()
    assert len(lines) == 1, text
    assert lines[0].startswith("runglight: ")
    assert file in lines[0]
    assert "defect" not in lines[0], "an unexpected error is no clear sentence"
    assert len(lines[0]) < 700
    assert lines[0].isprintable()


def test_enough_kinds() -> None:
    assert len(CASES) >= 60


@pytest.mark.parametrize("make", ["directory", "missing", "fifo", "link to itself"])
def test_what_is_no_file(runglight: Command, tmp_path: Path, make: str) -> None:
    import os  # noqa: PLC0415

    path = tmp_path / "log.csv"
    if make == "directory":
        path.mkdir()
    elif make == "fifo":
        os.mkfifo(path)
    elif make == "link to itself":
        path.symlink_to(path)
    ended = runglight("import", path, "--to", "out.csv")
    assert ended.returncode == 2
    assert_one_sentence(ended.stderr, "log.csv")


def damaged_models(model: Path) -> Iterator[tuple[str, Callable[[], object]]]:
    manifest, rules = model / "manifest.json", model / "rules.parquet"
    yield "no manifest", manifest.unlink
    yield "empty manifest", lambda: manifest.write_bytes(b"")
    yield "manifest of another kind", lambda: manifest.write_text("[]")
    yield "a future format", lambda: manifest.write_text('{"format": 999}')
    yield "no rules", rules.unlink
    yield "truncated rules", lambda: rules.write_bytes(rules.read_bytes()[:-50])
    yield "junk rules", lambda: rules.write_bytes(JUNK)
    yield "foreign rules", lambda: rules.write_bytes(parquet(changes(3)))


@pytest.mark.parametrize("number", range(8))
def test_a_damaged_model_is_refused(
    runglight: Command, cell: Path, tmp_path: Path, number: int
) -> None:
    import shutil  # noqa: PLC0415

    model = Path(shutil.copytree(cell / "cell.model", tmp_path / "cell.model"))
    _, damage = list(damaged_models(model))[number]
    damage()
    for command in (["show", model], ["watch", model, cell / "faulty.csv"]):
        ended = runglight(*command)
        assert ended.returncode == 2, ended
        assert_one_sentence(ended.stderr, "cell.model")
