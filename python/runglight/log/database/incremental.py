"""What is new in a table since the last time, into a directory."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec
import numpy as np

from runglight.errors import InputError
from runglight.log.database.bookmark import Bookmark, RowsById, RowsByTime
from runglight.log.database.by_id import next_by_id
from runglight.log.database.by_time import next_by_time
from runglight.log.database.connection import connected
from runglight.log.database.ignition import IgnitionHistory
from runglight.log.database.reading import found_source
from runglight.log.database.row_file import read_pages
from runglight.log.database.url import database_url, place_of
from runglight.log.imported import ImportDirectory
from runglight.log.imported.manifest import FILE, damaged

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from contextlib import AbstractContextManager

    from sqlalchemy import Connection

    from runglight.log.changelog import Log
    from runglight.log.database.single_table import SingleTable
    from runglight.log.database.step import Step
    from runglight.log.options import ReadOptions

ROWS_AT_ONCE = 100_000


def directory_for(options: ReadOptions, path: Path) -> AbstractContextManager[ImportDirectory]:
    """The directory for a table, opened or made."""
    url = database_url(options.sql or "")
    table = options.table or "the only tag history"
    return ImportDirectory.opened(path, f"{table.casefold()} of {place_of(url)}")


def import_new(
    options: ReadOptions, directory: ImportDirectory, renaming: Callable[[Log], Log] | None = None
) -> Iterator[Log]:
    """Takes every row that is new, step by step; gives the log of each, already on disk.

    InputError names the table and the row; what was taken in steps before it stays.
    """
    url = database_url(options.sql or "")
    with connected(url) as connection:
        source = found_source(connection, url, options)
        while (step := _next(connection, source, directory, options)) is not None:
            bookmark = msgspec.to_builtins(step.bookmark)
            if not step.page.cells:
                directory.add(None, bookmark, step.page.left_out)
                continue
            with tempfile.TemporaryDirectory(prefix="runglight-") as place:
                log = read_pages([step.page], source, Path(place), options)
            _refuse_samples(log, source, options)
            log, late = _in_time(log, source, directory, options)
            if renaming is not None:
                log = renaming(log)
            directory.add(log, bookmark, step.page.left_out + log.report.bad_rows + late)
            yield log


def _next(
    connection: Connection,
    source: SingleTable | IgnitionHistory,
    directory: ImportDirectory,
    options: ReadOptions,
) -> Step | None:
    bookmark = _bookmark(directory)
    if not isinstance(source, IgnitionHistory):
        source.refuse_times_of_day(connection)
        if source.counted:
            if isinstance(bookmark, RowsByTime):
                raise damaged(directory.path / FILE, "its bookmark is a time, not an id")
            return next_by_id(connection, source, bookmark, ROWS_AT_ONCE)
        if not source.times:
            raise InputError(
                f"{source.shown}: has neither an id that the database holds unique nor times that "
                "it can sort; write it to a file (--to plant.parquet)"
            )
    if isinstance(bookmark, RowsById):
        raise damaged(directory.path / FILE, "its bookmark is an id, not a time")
    step = next_by_time(
        connection,
        source,
        bookmark,
        ROWS_AT_ONCE,
        reorder_s=options.reorder_s,
        time_format="ms" if isinstance(source, IgnitionHistory) else options.time_format,
    )
    if step is None or bookmark is not None or isinstance(source, IgnitionHistory):
        return step
    return _with_timeless(step, source, source.rows_without_time(connection), options)


def _with_timeless(step: Step, source: SingleTable, count: int, options: ReadOptions) -> Step:
    """The first step, which also answers for rows that going by time never meets."""
    if count and options.on_error == "fail":
        have = "1 row has" if count == 1 else f"{count:,} rows have"
        raise InputError(
            f"{source.shown}: {have} no time in column {source.times[0]!r}; "
            "mend the table, or --on-error skip"
        )
    page = replace(step.page, timeless=count)
    return replace(step, page=page)


def _bookmark(directory: ImportDirectory) -> Bookmark | None:
    if directory.bookmark is None:
        return None
    try:
        bookmark: Bookmark = msgspec.convert(directory.bookmark, Bookmark)
        if isinstance(bookmark, RowsByTime) and bookmark.since is not None:
            bookmark.since.value()
    except (msgspec.ValidationError, ValueError, ArithmeticError) as error:
        raise damaged(directory.path / FILE, f"its bookmark: {error}") from None
    return bookmark


def _refuse_samples(log: Log, source: SingleTable | IgnitionHistory, options: ReadOptions) -> None:
    # Which columns are analog, and what changed, is known of a table as a whole only.
    if options.bits or (log.signals and set(log.signals) <= set(source.columns)):
        raise InputError(
            f"{source.shown}: holds samples, one column per signal, which are not taken piece by "
            "piece; write it to a file (--to plant.parquet)"
        )


def _in_time(
    log: Log,
    source: SingleTable | IgnitionHistory,
    directory: ImportDirectory,
    options: ReadOptions,
) -> tuple[Log, int]:
    """The rows that are not too late beside those of steps before, and how many were."""
    if directory.newest_ns is None or not len(log):
        return log, 0
    oldest_ns = directory.newest_ns - round(options.reorder_s * 1e9)
    late = int(np.searchsorted(log.columns()[0], oldest_ns, "left"))
    if late == 0:
        return log, 0
    time_ns, signal, _ = (column[0] for column in log.columns())
    sentence = (
        f"a row of {log.signals[int(signal)]} at {log.start} lies "
        f"{(directory.newest_ns - int(time_ns)) / 1e9:.3f} s before one that was imported, "
        f"expected at most the reorder window of {options.reorder_s:.3f} s"
    )
    if options.on_error == "fail":
        raise InputError(
            f"{source.shown}: {sentence} (widen it with --reorder, or --on-error skip)"
        )
    rest = log.slice(late)
    rest.report.notes.append(f"{late:,} late rows were skipped: {sentence}")
    return rest, late
