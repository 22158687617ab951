"""The next rows of a table whose rows are numbered."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sqlalchemy import or_

from runglight.log.database.bookmark import RowsById, mark_of
from runglight.log.database.step import Step, refuse_other_table

if TYPE_CHECKING:
    from collections.abc import Iterable

    from sqlalchemy import Connection

    from runglight.log.database.single_table import SingleTable

HOLES = 200
"""Stretches of missing numbers that are asked for again; those of older ones were deleted."""


def next_by_id(
    connection: Connection, source: SingleTable, bookmark: RowsById | None, rows_at_once: int
) -> Step | None:
    """Rows of higher ids, and late ones of ids that were skipped; None where there are none."""
    number = source.place.c[source.number or ""]
    rows = source.fetched().order_by(number)
    late = []
    if bookmark is not None:
        known = connection.execute(rows.where(number == bookmark.last)).first()
        if known is None or mark_of(source.times_of(known)) != bookmark.mark:
            raise refuse_other_table(source.shown, f"its row of {number.name} {bookmark.last}")
        if bookmark.holes:
            holes = or_(*(number.between(first, end) for first, end in bookmark.holes))
            late = list(connection.execute(rows.where(holes).limit(rows_at_once)))
        rows = rows.where(number > bookmark.last)
    fresh = list(connection.execute(rows.limit(rows_at_once)))
    connection.rollback()
    if not late and not fresh:
        return None
    holes_left = _without([] if bookmark is None else bookmark.holes, [int(r[-1]) for r in late])
    if bookmark is not None:
        before = bookmark.last
    else:
        # The first numbers may still be on their way too.
        first = int(fresh[0][-1])
        before = max(first - 1 - HOLES, min(first - 1, 0))
    for row in fresh:
        if int(row[-1]) > before + 1:
            holes_left.append((before + 1, int(row[-1]) - 1))
        before = int(row[-1])
    if fresh:
        last, mark = int(fresh[-1][-1]), mark_of(source.times_of(fresh[-1]))
    else:
        assert bookmark is not None
        last, mark = bookmark.last, bookmark.mark
    return Step(source.page([*late, *fresh]), RowsById(last, mark, holes_left[-HOLES:]))


def _without(holes: Iterable[tuple[int, int]], found: list[int]) -> list[tuple[int, int]]:
    """The holes that are left when numbers in them, in ascending order, were found."""
    left = []
    for first, end in holes:
        start = first
        for number in found:
            if start <= number <= end:
                if number > start:
                    left.append((start, number - 1))
                start = number + 1
        if start <= end:
            left.append((start, end))
    return left
