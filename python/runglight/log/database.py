"""Logs that stand in a table of a database: any that SQLAlchemy reaches.

The rows are fetched in time order, written to a temporary CSV file, and read from there as every
other file is, so that columns, times, errors and reports are the same
(docs/decisions/0004-tables-through-a-temporary-file.md).
"""

from __future__ import annotations

import csv
import re
import tempfile
import warnings
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
from sqlalchemy import column, create_engine, inspect, select, table
from sqlalchemy.dialects.mysql import BIT
from sqlalchemy.engine import make_url
from sqlalchemy.exc import ArgumentError, NoSuchModuleError, SQLAlchemyError
from sqlalchemy.pool import NullPool

from runglight import _engine
from runglight.errors import InputError
from runglight.log.changelog import Log
from runglight.log.report import BadRow, ReadReport
from runglight.nearest import suggestion

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from sqlalchemy import Connection, Select
    from sqlalchemy.engine import URL

    from runglight.log.options import ReadOptions

ROWS_AT_ONCE = 50_000

# Column names that say "time", the best first: those of the file reader (crates/formats,
# layout.rs), without case, blanks and punctuation. A test holds the two lists together.
TIME_NAMES = (
    *("timestamp", "time", "datetime", "dateandtime", "timestring", "timestamputc", "timeutc"),
    *("utc", "ts", "eventtime", "logtime", "localtime", "timetimestamp", "date", "zeit"),
    *("zeitstempel", "t"),
)

# KEPServerEX DataLogger writes the OPC quality of each value (OPC DA 3.0, 6.8): 192 is good.
QUALITY = "_quality"
GOOD = "192"

EXAMPLES = "sqlite:///plant.db or postgresql://user@host/database"
_DATABASES = ("sqlite", "postgresql", "mysql", "mariadb", "mssql", "oracle")
# SQLAlchemy's own choice differs between its versions, or needs a compiler.
_DRIVERS = {
    "postgresql": "postgresql+psycopg",
    "mysql": "mysql+pymysql",
    "mariadb": "mariadb+pymysql",
}
_PACKAGES = {
    "psycopg": '"psycopg[binary]"',
    "psycopg2": "psycopg2-binary",
    "MySQLdb": "mysqlclient",
    "pymysql": "PyMySQL",
}
_CONNECT_TIMEOUT_S = 10
_SORTS_AS_TEXT = re.compile(r"\s*\d{4}([-/.])\d\d\1\d\d")


def read_table(options: ReadOptions) -> Log:
    """Reads the table that `options.sql` and `options.table` name."""
    url = _url(options.sql or "")
    with _connected(url) as connection:
        source = _Source.find(connection, url, options)
        with tempfile.TemporaryDirectory(prefix="runglight-") as directory:
            return _through_file(connection, source, Path(directory) / "table.csv", options)


@dataclass(frozen=True)
class _Source:
    """A table that was found, and how its rows are asked for."""

    shown: str
    """What the user is told it is called; without the password."""
    columns: list[str]
    """The columns a log may be made of."""
    rows: Select[Any]
    """Those columns in time order, behind them the quality where there is one."""
    quality: str | None
    """The column by which rows are skipped."""
    ordered: bool
    """True where rows of one time have an order of their own."""

    @classmethod
    def find(cls, connection: Connection, url: URL, options: ReadOptions) -> _Source:
        schema, name = _found_table(connection, url, options.table)
        inspector = inspect(connection)
        with warnings.catch_warnings():
            # Columns of types that SQLAlchemy does not know are read as they come.
            warnings.simplefilter("ignore")
            described = inspector.get_columns(name, schema)
            key = inspector.get_pk_constraint(name, schema).get("constrained_columns") or []
        names = [each["name"] for each in described]
        asked = {_plain(each) for each in _asked_columns(options)}

        def unasked(wanted: str) -> str | None:
            same = (each for each in names if each.casefold() == wanted)
            return next((each for each in same if _plain(each) not in asked), None)

        number, quality = unasked("id"), unasked(QUALITY)
        columns = [each for each in names if each not in {number, quality}]
        # Text and numbers come as they stand, for the engine to read; only MySQL's bits would
        # come as bytes.
        columns_by_name = {
            each["name"]: column(each["name"], each["type"])
            if isinstance(each["type"], BIT)
            else column(each["name"])
            for each in described
        }
        place = table(name, *columns_by_name.values(), schema=schema)
        times = _time_columns(names, options.time_column)
        if times and not _sorts(connection, select(place.c[times[0]]).select_from(place)):
            times = []
        ties = [number] if number is not None else key
        order = dict.fromkeys([*times, *ties])
        fetched = columns if quality is None else [*columns, quality]
        return cls(
            shown=f"table {name if schema is None else f'{schema}.{name}'} of {_shown(url)}",
            columns=columns,
            rows=select(*(place.c[each] for each in fetched)).order_by(
                *(place.c[each] for each in order)
            ),
            quality=quality,
            ordered=bool(ties),
        )


def _through_file(connection: Connection, source: _Source, path: Path, options: ReadOptions) -> Log:
    reading = msgspec.structs.replace(options, format="csv", delimiter=",").to_json()
    skipped = 0
    with path.open("w", encoding="utf-8", newline="", errors="surrogateescape") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(source.columns)
        for position, rows in enumerate(_partitions(connection, source.rows)):
            if position == 1:
                # A table that is no log says so before all of it is fetched.
                stream.flush()
                _read(path, reading, source)
            kept = rows if source.quality is None else [row[:-1] for row in rows if _good(row[-1])]
            skipped += len(rows) - len(kept)
            writer.writerows(map(_cells, kept))
    engine_log = _read(path, reading, source)
    report = _report(engine_log, source)
    if skipped:
        were = "row was" if skipped == 1 else "rows were"
        report.notes.append(
            f"{skipped:,} {were} skipped, because {source.quality} is not {GOOD} (good)"
        )
    return Log(engine_log, source.shown, report)


def _partitions(connection: Connection, rows: Select[Any]) -> Iterator[Sequence[Any]]:
    with connection.execution_options(yield_per=ROWS_AT_ONCE).execute(rows) as result:
        yield from result.partitions()


def _cells(row: Sequence[Any]) -> list[Any]:
    return [
        cell.decode("utf-8", "surrogateescape") if isinstance(cell, bytes) else cell for cell in row
    ]


def _good(quality: object) -> bool:
    return str(quality).strip() == GOOD


def _read(path: Path, reading: str, source: _Source) -> _engine.ChangeLog:
    try:
        return _engine.read_log(str(path), reading)
    except InputError as error:
        place, _, problem = str(error).partition(f"{path}: ")
        if place:
            raise
        raise InputError(f"{source.shown}: {_of_table(problem)}") from None


def _of_table(problem: str) -> str:
    """The engine's words on the temporary file as words on the table."""
    problem = problem.replace("the file", "the table")
    header = re.match(r"row (\d+): ", problem)
    if header is None:
        return problem
    # Row 1 of the file is its header; a table counts from its first row.
    row = int(header[1]) - 1
    return f"{f'row {row}: ' if row else ''}{problem[header.end() :]}"


def _report(engine_log: _engine.ChangeLog, source: _Source) -> ReadReport:
    report = msgspec.json.decode(engine_log.report_json, type=ReadReport)
    notes = [_of_table(note) for note in report.notes]
    if not source.ordered:
        notes.append("it has no id: rows of one time come in the order the database gives them")
    bad = [BadRow(bad.row - 1, bad.reason) for bad in report.bad]
    return msgspec.structs.replace(report, format="sql", bad=bad, notes=notes)


def _url(text: str) -> URL:
    try:
        url = make_url(text)
    except (ArgumentError, ValueError):
        # What cannot be parsed is not repeated: a password may be in it.
        raise InputError(f"--sql: this is no database URL; write it like {EXAMPLES}") from None
    url = url.set(drivername=_DRIVERS.get(url.drivername, url.drivername))
    if url.drivername.endswith(("+psycopg", "+psycopg2")) and "connect_timeout" not in url.query:
        url = url.update_query_dict({"connect_timeout": str(_CONNECT_TIMEOUT_S)})
    return url


@contextmanager
def _connected(url: URL) -> Iterator[Connection]:
    _refuse_missing_file(url)
    try:
        connection = create_engine(url, poolclass=NullPool).connect()
    except NoSuchModuleError:
        database = url.get_backend_name()
        near = suggestion(database, _DATABASES) or f"; write it like {EXAMPLES}"
        raise InputError(f"--sql: no database is known as {url.drivername!r}{near}") from None
    except ModuleNotFoundError as missing:
        driver = (missing.name or url.get_driver_name()).partition(".")[0]
        raise InputError(
            f"{_shown(url)}: its driver {driver} is not installed: "
            f"pip install {_PACKAGES.get(driver, driver)}"
        ) from None
    except Exception as error:  # A driver may raise what it likes.
        raise InputError(
            f"{_shown(url)}: cannot connect: {_reason(error, url)}; "
            "check address, user and password"
        ) from None
    try:
        with connection:
            yield connection
    except SQLAlchemyError as error:
        raise InputError(f"{_shown(url)}: cannot read: {_reason(error, url)}") from None


def _refuse_missing_file(url: URL) -> None:
    # SQLite would make an empty database.
    file = url.database
    if url.get_backend_name() != "sqlite" or not file or file.startswith((":memory:", "file:")):
        return
    if not Path(file).is_file():
        raise InputError(f"{file}: there is no such SQLite file; check the path in --sql")


def _shown(url: URL) -> str:
    # The query may hold a password too.
    return url.set(query={}).render_as_string(hide_password=True)


def _reason(error: Exception, url: URL) -> str:
    """What the driver says, in one line without secrets."""
    original = getattr(error, "orig", None) or error
    text = " ".join(str(original).split()) or type(original).__name__
    for secret in _secrets(url):
        text = text.replace(secret, "***")
    text = text.removesuffix(".")
    return text if len(text) <= 300 else f"{text[:299]}…"


def _secrets(url: URL) -> Iterator[str]:
    if url.password:
        yield str(url.password)
    for key, value in url.query.items():
        for text in [value] if isinstance(value, str) else value:
            if re.search("pass|pwd|secret|token", key, re.IGNORECASE):
                yield text
            # A whole ODBC connection string: `DRIVER=…;UID=…;PWD=…`.
            yield from re.findall(r"(?:pwd|password)\s*=\s*([^;]+)", text, re.IGNORECASE)


def _found_table(connection: Connection, url: URL, asked: str | None) -> tuple[str | None, str]:
    """Schema and name of a table or view, as the database writes them."""
    inspector = inspect(connection)
    known = [*inspector.get_table_names(), *inspector.get_view_names()]
    if asked is None:
        raise InputError(f"{_shown(url)}: which table? give --table{_listed(known)}")
    if found := _as_written(asked, known):
        return None, found
    schema, dot, name = asked.rpartition(".")
    if dot and (place := _as_written(schema, inspector.get_schema_names())):
        inside = [*inspector.get_table_names(place), *inspector.get_view_names(place)]
        if found := _as_written(name, inside):
            return place, found
        known = [f"{place}.{each}" for each in inside]
    near = suggestion(asked, known) or _listed(known)
    raise InputError(f"{_shown(url)}: there is no table {asked!r}{near}")


def _as_written(asked: str, known: Iterable[str]) -> str | None:
    known = list(known)
    if asked in known:
        return asked
    alike = [each for each in known if each.casefold() == asked.casefold()]
    return alike[0] if len(alike) == 1 else None


def _listed(known: Sequence[str]) -> str:
    if not known:
        return "; the database has none"
    shown = ", ".join(sorted(known)[:8]) + (", …" if len(known) > 8 else "")
    return f"; there {'is' if len(known) == 1 else 'are'} {shown}"


def _plain(name: str) -> str:
    """A column's name as the file reader compares it: `_TIMESTAMP`, `Time stamp`, `time [ms]`."""
    return "".join(filter(str.isalnum, re.split(r"[\[(]", name)[0])).lower()


def _asked_columns(options: ReadOptions) -> Iterator[str]:
    for name in (options.time_column, options.value_column):
        if name is not None:
            yield name
    yield from (*options.signal_columns, *options.analog, *options.bits)


def _time_columns(names: Sequence[str], asked: str | None) -> list[str]:
    """The columns that hold the time, by name: chosen as the file reader chooses."""
    plain: dict[str, str] = {}
    for name in names:
        plain.setdefault(_plain(name), name)
    if asked is not None:
        found = asked if asked in names else plain.get(_plain(asked))
        return [found] if found else []
    if "date" in plain and "time" in plain:
        return [plain["date"], plain["time"]]
    named = (plain[known] for known in TIME_NAMES if known in plain)
    begun = (plain[each] for each in plain if each.startswith(("time", "date")))
    found = next(named, None) or next(begun, None)
    return [found] if found else []


def _sorts(connection: Connection, times: Select[Any]) -> bool:
    """True where the database's order is the order in time: of `31.01.2026` or `06:00` it is not.

    Such rows are read in the order of their ids, as they would stand in a file.
    """
    first = connection.execute(
        times.where(times.selected_columns[0].is_not(None)).limit(1)
    ).scalar_one_or_none()
    if isinstance(first, str):
        return _SORTS_AS_TEXT.match(first) is not None
    # A time of day (`datetime.time`, MySQL's `timedelta`) starts anew every midnight.
    return type(first).__name__ not in {"time", "timedelta"}
