"""One table or view: paper 003's, KEPServerEX DataLogger's, or any that reads like a file."""

from __future__ import annotations

import re
import warnings
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from sqlalchemy import Integer, Numeric, column, func, inspect, select, table
from sqlalchemy.dialects.mysql import BIT

from runglight.errors import InputError
from runglight.log.database import quality as opc
from runglight.log.database.columns import asked_columns, plain, sorts, time_columns
from runglight.log.database.page import Page
from runglight.log.database.tables import found_table
from runglight.log.database.url import shown
from runglight.log.options import ReadOptions

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from sqlalchemy import Connection, Select, TableClause
    from sqlalchemy.engine import URL

    from runglight.log.report import LeftOut

ROWS_AT_ONCE = 50_000
_TIME_OF_DAY = re.compile(r"\s*\d{1,2}:\d\d")


@dataclass(frozen=True)
class SingleTable:
    """A table that was found, and how its rows are asked for."""

    shown: str
    columns: list[str]
    place: TableClause
    times: list[str]
    """The columns that hold the time; none where the database cannot sort by them."""
    time_names: list[str]
    """The columns that hold the time."""
    number: str | None
    """The column that numbers the rows."""
    counted: bool
    """True where the database holds that number to be whole, unique and always there."""
    key: list[str]
    """The columns of the primary key."""
    quality: str | None
    """The column by which rows are skipped."""
    notes: list[str] = field(default_factory=list)
    left_out: list[LeftOut] = field(default_factory=list)

    @classmethod
    def find(cls, connection: Connection, url: URL, options: ReadOptions) -> SingleTable:
        """The table that options name; InputError where there is none."""
        schema, name = found_table(connection, url, options.table)
        inspector = inspect(connection)
        with warnings.catch_warnings():
            # Columns of types that SQLAlchemy does not know are read as they come.
            warnings.simplefilter("ignore")
            described = inspector.get_columns(name, schema)
            key = inspector.get_pk_constraint(name, schema).get("constrained_columns") or []
            unique = [
                each["column_names"]
                for each in inspector.get_indexes(name, schema)
                if each["unique"]
            ]
        names = [each["name"] for each in described]
        nullable = {each["name"]: each.get("nullable", True) for each in described}
        types = {each["name"]: each["type"] for each in described}
        asked = {plain(each) for each in asked_columns(options)}

        def unasked(wanted: str) -> str | None:
            same = (each for each in names if each.casefold() == wanted)
            return next((each for each in same if plain(each) not in asked), None)

        number, quality = unasked("id"), unasked(opc.QUALITY)
        # Text and numbers come as they stand, for the engine to read; only MySQL's bits would
        # come as bytes.
        place = table(
            name,
            *(
                column(each["name"], each["type"])
                if isinstance(each["type"], BIT)
                else column(each["name"])
                for each in described
            ),
            schema=schema,
        )
        times = time_names = time_columns(names, options.time_column)
        if times and not sorts(connection, select(place.c[times[0]]).select_from(place)):
            times = []
        found = cls(
            shown=f"table {name if schema is None else f'{schema}.{name}'} of {shown(url)}",
            columns=[each for each in names if each not in {number, quality}],
            place=place,
            times=times,
            time_names=time_names,
            number=number,
            counted=number is not None
            and (key == [number] or ([number] in unique and not nullable[number]))
            and isinstance(types[number], (Integer, Numeric)),
            key=key,
            quality=quality,
        )
        if not found.ties:
            found.notes.append(
                "it has no id: rows of one time come in the order the database gives them"
            )
        return found

    @property
    def ties(self) -> list[str]:
        """The columns that give rows of one time an order of their own."""
        return self.key if self.number is None else [self.number]

    @property
    def bad_quality(self) -> str:
        """Why rows are skipped."""
        return f"{self.quality} is not {opc.GOOD} (good)"

    def reading(self, options: ReadOptions) -> ReadOptions:
        """As the options say."""
        return options

    @property
    def fetched_names(self) -> list[str]:
        """The columns, behind them the quality and the number where there are such."""
        behind = (each for each in (self.quality, self.number) if each is not None)
        return [*self.columns, *behind]

    def fetched(self) -> Select[Any]:
        """Asks for all rows."""
        return select(*(self.place.c[each] for each in self.fetched_names))

    def rows_since(self, connection: Connection, since: Any, limit: int) -> Sequence[Any]:
        """The first rows from a time on (None: of all), in time order."""
        time = self.place.c[self.times[0]]
        order = dict.fromkeys([*self.times, *self.ties])
        rows = self.fetched().order_by(*(self.place.c[each] for each in order)).limit(limit)
        return connection.execute(
            rows.where(time.is_not(None) if since is None else time >= since)
        ).all()

    def rows_without_time(self, connection: Connection) -> int:
        """Number of rows that no time leads to."""
        time = self.place.c[self.times[0]]
        missing = select(func.count()).select_from(self.place).where(time.is_(None))
        count = int(connection.execute(missing).scalar_one())
        # Counting began a transaction: the historian must not wait for us to end it.
        connection.rollback()
        return count

    def times_of(self, row: Sequence[Any]) -> list[Any]:
        """The time of a row, as the database has it."""
        return [row[self.fetched_names.index(each)] for each in self.time_names]

    def identity_of(self, row: Sequence[Any]) -> list[Any]:
        """What tells a row from others: its primary key, else all of it."""
        if not self.key:
            return list(row)
        return [row[self.fetched_names.index(each)] for each in self.key]

    def refuse_times_of_day(self, connection: Connection) -> None:
        """InputError for a table of times of day: a part of it does not tell the day."""
        if self.times or not self.time_names:
            return
        time = self.place.c[self.time_names[0]]
        first = connection.execute(
            select(time).where(time.is_not(None)).limit(1)
        ).scalar_one_or_none()
        if type(first).__name__ in {"time", "timedelta"} or (
            isinstance(first, str) and _TIME_OF_DAY.match(first)
        ):
            raise InputError(
                f"{self.shown}: its column {time.name!r} has times of day only, which are not "
                "taken piece by piece; write it to a file (--to plant.parquet)"
            )

    def page(self, rows: Sequence[Sequence[Any]]) -> Page:
        """What of fetched rows is to be read."""
        width = len(self.columns)
        kept = rows if self.quality is None else [row for row in rows if opc.good(row[width])]
        return Page(
            [row[:width] for row in kept],
            None if self.number is None else [f"{self.number} {row[-1]}" for row in kept],
            skipped=len(rows) - len(kept),
        )

    def pages(self, connection: Connection) -> Iterator[Page]:
        """All rows in time order, as the server sends them."""
        order = dict.fromkeys([*self.times, *self.ties])
        rows = self.fetched().order_by(*(self.place.c[each] for each in order))
        streamed = connection.execution_options(yield_per=ROWS_AT_ONCE)
        with streamed.execute(rows) as result:
            for part in result.partitions():
                yield self.page(part)
