"""The temporary file through which rows reach the engine, and its words as words on the table."""

from __future__ import annotations

import csv
import re
from itertools import islice
from typing import TYPE_CHECKING, Any

import msgspec

from runglight import _engine
from runglight.errors import InputError
from runglight.log.changelog import Log
from runglight.log.report import BadRow, ReadReport

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

    from runglight.log.database.page import Page, Source
    from runglight.log.options import ReadOptions

_ROW = re.compile(r"row (\d+): ")


def read_pages(pages: Iterable[Page], source: Source, directory: Path, options: ReadOptions) -> Log:
    """Reads rows as a file would be read; InputError names the table and the row."""
    return _RowFile(source, directory, options).read(pages)


class _RowFile:
    def __init__(self, source: Source, directory: Path, options: ReadOptions) -> None:
        self._source = source
        self._path = directory / "table.csv"
        self._names_path = directory / "names.txt"
        self._named = False
        self._reading = msgspec.structs.replace(
            source.reading(options), format="csv", delimiter=","
        ).to_json()

    def read(self, pages: Iterable[Page]) -> Log:
        skipped = unknown = timeless = 0
        with (
            self._path.open("w", encoding="utf-8", newline="", errors="surrogateescape") as stream,
            self._names_path.open("w", encoding="utf-8") as names,
        ):
            writer = csv.writer(stream, lineterminator="\n")
            writer.writerow(self._source.columns)
            for position, page in enumerate(pages):
                if position == 1:
                    # A table that is no log says so before all of it is fetched.
                    stream.flush()
                    names.flush()
                    self._engine_log()
                writer.writerows(map(_cells, page.cells))
                if page.names is not None:
                    self._named = True
                    names.writelines(f"{name}\n" for name in page.names)
                skipped += page.skipped
                unknown += page.unknown
                timeless += page.timeless
        engine_log = self._engine_log()
        return Log(
            engine_log, self._source.shown, self._report(engine_log, skipped, unknown, timeless)
        )

    def _engine_log(self) -> _engine.ChangeLog:
        try:
            return _engine.read_log(str(self._path), self._reading)
        except InputError as error:
            place, _, problem = str(error).partition(f"{self._path}: ")
            if place:
                raise
            raise InputError(f"{self._source.shown}: {self._of_table(problem)}") from None

    def _report(
        self, engine_log: _engine.ChangeLog, skipped: int, unknown: int, timeless: int
    ) -> ReadReport:
        report = msgspec.json.decode(engine_log.report_json, type=ReadReport)
        notes = [*map(self._of_table, report.notes), *self._source.notes]
        if skipped:
            notes.append(f"{_rows(skipped)} skipped, because {self._source.bad_quality}")
        if unknown:
            notes.append(f"{_rows(unknown)} skipped, because no tag has their number")
        if timeless:
            notes.append(f"{_rows(timeless)} skipped, because they have no time")
        return msgspec.structs.replace(
            report,
            format="sql",
            bad=[
                BadRow(bad.row - 1, f"{bad.reason}{self._name_of(bad.row - 1)}")
                for bad in report.bad
            ],
            left_out=[*report.left_out, *self._source.left_out],
            notes=notes,
        )

    def _of_table(self, problem: str) -> str:
        problem = problem.replace("the file", "the table")
        header = _ROW.match(problem)
        if header is None:
            return problem
        # Row 1 of the file is its header; a table counts from its first row.
        row = int(header[1]) - 1
        text = problem[header.end() :]
        return f"row {row}: {text}{self._name_of(row)}" if row else text

    def _name_of(self, row: int) -> str:
        if not self._named or row < 1:
            return ""
        with self._names_path.open(encoding="utf-8") as names:
            name = next(islice(names, row - 1, None), "").rstrip("\n")
        return f" [{name}]" if name else ""


def _rows(count: int) -> str:
    return "1 row was" if count == 1 else f"{count:,} rows were"


def _cells(row: Sequence[Any]) -> list[Any]:
    return [
        cell.decode("utf-8", "surrogateescape") if isinstance(cell, bytes) else cell for cell in row
    ]
