"""Which columns hold the time, told by name as the file reader does."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from sqlalchemy import Connection, Select

    from runglight.log.options import ReadOptions

# Column names that say "time", the best first: those of the file reader (crates/formats,
# layout.rs), without case, blanks and punctuation. A test holds the two lists together.
TIME_NAMES = (
    *("timestamp", "time", "datetime", "dateandtime", "timestring", "timestamputc", "timeutc"),
    *("utc", "ts", "eventtime", "logtime", "localtime", "timetimestamp", "date", "zeit"),
    *("zeitstempel", "t"),
)

_SORTS_AS_TEXT = re.compile(r"\s*\d{4}([-/.])\d\d\1\d\d")


def plain(name: str) -> str:
    """A column's name as the file reader compares it: `_TIMESTAMP`, `Time stamp`, `time [ms]`."""
    return "".join(filter(str.isalnum, re.split(r"[\[(]", name)[0])).lower()


def asked_columns(options: ReadOptions) -> Iterator[str]:
    """The columns that options name."""
    for name in (options.time_column, options.value_column):
        if name is not None:
            yield name
    yield from (*options.signal_columns, *options.analog, *options.bits)


def time_columns(names: Sequence[str], asked: str | None) -> list[str]:
    """The columns that hold the time, by name: chosen as the file reader chooses."""
    by_plain_name: dict[str, str] = {}
    for name in names:
        by_plain_name.setdefault(plain(name), name)
    if asked is not None:
        found = asked if asked in names else by_plain_name.get(plain(asked))
        return [found] if found else []
    if "date" in by_plain_name and "time" in by_plain_name:
        return [by_plain_name["date"], by_plain_name["time"]]
    named = (by_plain_name[known] for known in TIME_NAMES if known in by_plain_name)
    begun = (by_plain_name[each] for each in by_plain_name if each.startswith(("time", "date")))
    found = next(named, None) or next(begun, None)
    return [found] if found else []


def sorts(connection: Connection, times: Select[Any]) -> bool:
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
