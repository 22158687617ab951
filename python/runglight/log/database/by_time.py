"""The next rows of a table that has nothing but times to go by.

Rows may come late: all that are at most the reorder window older than the newest are asked for
again, and those that were read are told by their marks.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any, Protocol

from runglight.log.database.bookmark import RowsByTime, StoredTime, mark_of
from runglight.log.database.step import Step, refuse_other_table
from runglight.log.database.time_scale import seconds

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from sqlalchemy import Connection

    from runglight.log.database.page import Page


class Timed(Protocol):
    """What has rows in time order."""

    @property
    def shown(self) -> str:
        """What the user is told it is called."""

    def rows_since(self, connection: Connection, since: Any, limit: int) -> Sequence[Any]:
        """The first rows from a time on (None: of all), in time order."""

    def times_of(self, row: Any) -> Sequence[Any]:
        """The time of a row, as the database has it."""

    def identity_of(self, row: Any) -> Iterable[Any]:
        """What tells a row from others."""

    def page(self, rows: Sequence[Any]) -> Page:
        """What of fetched rows is to be read."""


def next_by_time(
    connection: Connection,
    source: Timed,
    bookmark: RowsByTime | None,
    rows_at_once: int,
    *,
    reorder_s: float,
    time_format: str | None,
) -> Step | None:
    """Rows that were not read before; None where there are none."""
    seen = Counter([] if bookmark is None else bookmark.seen)
    # So many more that a whole page of rows that were read never hides those behind it.
    limit = rows_at_once + seen.total()
    since = None if bookmark is None else bookmark.since
    rows = source.rows_since(connection, None if since is None else since.value(), limit)
    connection.rollback()
    complete = len(rows) < limit
    marks = [mark_of(source.identity_of(row)) for row in rows]
    unmatched = seen.copy()
    fresh = []
    for row, mark in zip(rows, marks, strict=True):
        if unmatched[mark] > 0:
            unmatched[mark] -= 1
        else:
            fresh.append((row, mark))
    if seen and complete and unmatched.total() == seen.total():
        raise refuse_other_table(source.shown, "each of its last rows")
    if not fresh:
        return None
    page = source.page([row for row, _ in fresh])
    if bookmark is not None and not complete and unmatched.total():
        # Rows that were read lie behind this page: the window moves when they were met again.
        return Step(page, RowsByTime(since, bookmark.seen + [mark for _, mark in fresh]))
    times = [source.times_of(row)[0] for row in rows]
    start = _window_start(times, reorder_s, time_format)
    if start > 0:
        since = StoredTime.of(times[start])
    return Step(page, RowsByTime(since, marks[start:]))


def _window_start(times: Sequence[Any], reorder_s: float, time_format: str | None) -> int:
    """Position of the rows of the last time that lies before the window; 0 where none does.

    That time is a bound that the database can compare with, in whatever form it keeps times.
    """
    newest = times[-1]
    newest_s = seconds(newest, time_format)
    start = len(times) - 1
    while start > 0 and not _is_before(times[start], newest, newest_s, reorder_s, time_format):
        start -= 1
    while start > 0 and times[start - 1] == times[start]:
        start -= 1
    return start


def _is_before(
    time: Any, newest: Any, newest_s: float | None, reorder_s: float, time_format: str | None
) -> bool:
    time_s = seconds(time, time_format)
    if time_s is None or newest_s is None:
        return bool(time != newest)
    return time_s < newest_s - reorder_s
