"""The tag history of Ignition: partitions of values, and tables that say what they are.

Tables and columns as Inductive Automation's manual has them, "Tag Historian, Ignition database
table reference": `sqlth_partitions` lists tables `sqlt_data_<driver>_<year>_<month>`, `sqlth_te`
names the tags, `sqlth_scinfo` and `sqlth_drv` say which system they are of.
"""

from __future__ import annotations

import heapq
from bisect import bisect_right
from collections import defaultdict
from dataclasses import dataclass, field
from itertools import chain, islice
from operator import itemgetter
from typing import TYPE_CHECKING, Any

import msgspec
from sqlalchemy import and_, column, inspect, or_, select, table

from runglight.errors import InputError
from runglight.log.database.page import Page
from runglight.log.database.quality import GOOD
from runglight.log.database.tables import as_written
from runglight.log.database.tag_names import signal_names
from runglight.log.database.url import shown
from runglight.log.report import LeftOut

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from sqlalchemy import Connection
    from sqlalchemy.engine import URL

    from runglight.log.options import ReadOptions

NAME = "ignition"
ROWS_AT_ONCE = 50_000
_TAGS = "sqlth_te"
_PARTITIONS = "sqlth_partitions"
_INTEGER, _FLOAT, _TEXT, _DATE = range(4)
_KINDS = {
    _FLOAT: "analog (--analog TAG=THRESHOLD bands it)",
    _TEXT: "text, not a number",
    _DATE: "a date, not a number",
}
_VALUES = ("tagid", "intvalue", "floatvalue", "dataintegrity", "t_stamp")

Row = tuple[int, int | None, float | None, int | None, int]
"""`tagid, intvalue, floatvalue, dataintegrity, t_stamp` (milliseconds since 1970)."""


@dataclass(frozen=True)
class IgnitionHistory:
    """All partitions of a tag history as one table of changes."""

    shown: str
    schema: str | None
    partitions: list[list[str]]
    """Names of the partitions in time order, one list for each driver."""
    ends_ms: Mapping[str, int]
    names: Mapping[int, str]
    """The signal of each tag that is read."""
    known: frozenset[int]
    """All tags, also those that are not read."""
    thresholds: Mapping[int, Sequence[float]]
    notes: list[str] = field(default_factory=list)
    left_out: list[LeftOut] = field(default_factory=list)
    columns: list[str] = field(default_factory=lambda: ["time", "signal", "value"])
    bad_quality: str = f"dataintegrity is below {GOOD} (good)"

    @classmethod
    def find(cls, connection: Connection, url: URL, options: ReadOptions) -> IgnitionHistory | None:
        """The history, where it is asked for, or where none of a historian's tables is."""
        place, dot, name = (options.table or NAME).rpartition(".")
        if name.casefold() != NAME:
            return None
        inspector = inspect(connection)
        schema = as_written(place, inspector.get_schema_names()) if dot else None
        if dot and schema is None:
            return None
        tables = inspector.get_table_names(schema)
        if options.table is not None and as_written(name, tables):
            return None  # A table of one's own that is called so.
        if as_written(_TAGS, tables) is None:
            if options.table is None or dot:
                return None
            raise InputError(
                f"{shown(url)}: there is no table {options.table!r}, and no tag history of "
                f"Ignition either, whose tables are {_TAGS}, {_PARTITIONS} and sqlt_data_…"
            )
        return cls._read(connection, f"tag history of {shown(url)}", schema, tables, options)

    @classmethod
    def _read(
        cls,
        connection: Connection,
        title: str,
        schema: str | None,
        tables: Sequence[str],
        options: ReadOptions,
    ) -> IgnitionHistory:
        def rows(name: str, *columns: str) -> list[Any]:
            found = as_written(name, tables)
            if found is None:
                return []
            place = table(found, *(column(each) for each in columns), schema=schema)
            return list(connection.execute(select(*place.c)))

        partitions: defaultdict[int, list[tuple[int, str]]] = defaultdict(list)
        ends_ms: dict[str, int] = {}
        for name, driver, start_ms, end_ms, block_size in rows(
            _PARTITIONS, "pname", "drvid", "start_time", "end_time", "blocksize"
        ):
            # Those with a block size are summaries; a partition that was pruned may stay listed.
            written = as_written(name, tables)
            if written is not None and not block_size:
                partitions[driver].append((start_ms or 0, written))
                ends_ms[written] = end_ms or 0
        systems = dict(map(tuple, rows("sqlth_scinfo", "id", "drvid")))
        drivers = dict(map(tuple, rows("sqlth_drv", "id", "name")))
        tags = rows(_TAGS, "id", "tagpath", "scid", "datatype")
        paths = {tag: (systems.get(system), path) for tag, path, system, _ in tags}
        names = signal_names(paths, drivers)
        read: dict[int, str] = {}
        thresholds: dict[int, Sequence[float]] = {}
        left_out: dict[str, str] = {}
        asked = {each: (t if isinstance(t, list) else [t]) for each, t in options.analog.items()}
        for tag, path, _, kind in tags:
            banding = asked.get(names[tag], asked.get(path))
            if banding is not None:
                thresholds[tag] = sorted(banding)
            if banding is not None or kind == _INTEGER:
                read[tag] = names[tag]
            else:
                left_out[names[tag]] = _KINDS.get(kind, "of an unknown type")
        missing = set(asked) - set(names.values()) - {path for _, path in paths.values()}
        if missing:
            raise InputError(f"{title}: has no tag {min(missing)!r} (option analog)")
        return cls(
            shown=title,
            schema=schema,
            partitions=[[name for _, name in sorted(each)] for each in partitions.values()],
            ends_ms=ends_ms,
            names=read,
            known=frozenset(names),
            thresholds=thresholds,
            left_out=[LeftOut(name, kind) for name, kind in left_out.items()],
        )

    def reading(self, options: ReadOptions) -> ReadOptions:
        """Times in milliseconds, and analog tags already banded."""
        return msgspec.structs.replace(
            options,
            time_column="time",
            signal_columns=["signal"],
            value_column="value",
            time_format="ms",
            analog={},
        )

    def pages(self, connection: Connection) -> Iterator[Page]:
        """All rows in time order."""
        rows = self.rows_from(connection, None, ROWS_AT_ONCE)
        while part := list(islice(rows, ROWS_AT_ONCE)):
            yield self.page(part)

    def page(self, rows: Sequence[Row]) -> Page:
        """What of fetched rows is to be read."""
        cells: list[Sequence[Any]] = []
        names = []
        skipped = unknown = 0
        for tag, integer, number, integrity, time_ms in rows:
            name = self.names.get(tag)
            if name is None:
                unknown += tag not in self.known
            elif integrity is None or integrity < GOOD:
                skipped += 1
            else:
                value = number if integer is None else integer
                if (thresholds := self.thresholds.get(tag)) is not None and value is not None:
                    value = bisect_right(thresholds, value)
                elif isinstance(value, float) and value.is_integer():
                    value = int(value)
                cells.append((time_ms, name, value))
                names.append(f"tagid {tag}, t_stamp {time_ms}")
        return Page(cells, names, skipped=skipped, unknown=unknown)

    def rows_since(self, connection: Connection, since: Any, limit: int) -> Sequence[Row]:
        """The first rows from a time on (None: of all), in time order."""
        return list(islice(self.rows_from(connection, since, min(limit, ROWS_AT_ONCE)), limit))

    def times_of(self, row: Row) -> list[int]:
        """The time of a row."""
        return [row[4]]

    def identity_of(self, row: Row) -> list[int]:
        """What tells a row from others: the key of the partitions."""
        return [row[0], row[4]]

    def rows_from(
        self, connection: Connection, since_ms: int | None, rows_at_once: int
    ) -> Iterator[Row]:
        """The rows of all partitions by time, from `since_ms` on; fetched as they are taken."""
        return heapq.merge(
            *(
                chain.from_iterable(
                    self._partition(connection, name, since_ms, rows_at_once)
                    for position, name in enumerate(names)
                    # Late values may lie outside what the last partition is said to hold.
                    if since_ms is None
                    or position == len(names) - 1
                    or self.ends_ms[name] >= since_ms
                )
                for names in self.partitions
            ),
            key=itemgetter(4),
        )

    def _partition(
        self, connection: Connection, name: str, since_ms: int | None, rows_at_once: int
    ) -> Iterator[Row]:
        # By key, never by offset: each page costs the same, and no cursor stays open over it.
        place = table(name, *(column(each) for each in _VALUES), schema=self.schema)
        time_ms, tag = place.c.t_stamp, place.c.tagid
        rows = select(*place.c).order_by(time_ms, tag).limit(rows_at_once)
        where = () if since_ms is None else (time_ms >= since_ms,)
        while True:
            page = connection.execute(rows.where(*where)).all()
            connection.rollback()
            yield from (tuple(row) for row in page)
            if len(page) < rows_at_once:
                return
            last = page[-1]
            where = (or_(time_ms > last[4], and_(time_ms == last[4], tag > last[0])),)
