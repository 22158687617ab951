"""How far a table was read, as `imported.json` keeps it."""

from __future__ import annotations

from datetime import date, datetime
from decimal import Decimal
from hashlib import blake2b
from typing import TYPE_CHECKING, Any, Literal

import msgspec

from runglight.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterable


class RowsById(msgspec.Struct, tag_field="by", tag="id", forbid_unknown_fields=True):
    """Every row up to an id was read, except those of numbers that were not there yet."""

    last: int
    mark: str
    """By which the row of that id is recognised."""
    holes: list[tuple[int, int]] = []
    """First and last of numbers not seen: transactions end in another order than they begin."""


class StoredTime(msgspec.Struct, forbid_unknown_fields=True):
    """A time as the database has it, so that it can be compared there."""

    kind: Literal["text", "integer", "number", "decimal", "datetime", "date"]
    text: str

    @classmethod
    def of(cls, value: Any) -> StoredTime:
        """From what a driver gives; InputError for what is no time."""
        match value:
            case str():
                return cls("text", value)
            case int() if not isinstance(value, bool):
                return cls("integer", str(value))
            case float():
                return cls("number", repr(value))
            case Decimal():
                return cls("decimal", str(value))
            case datetime():
                return cls("datetime", value.isoformat())
            case date():
                return cls("date", value.isoformat())
        raise InputError(f"a time is a {type(value).__name__}, expected a date, text or number")

    def value(self) -> Any:
        """What the driver gave."""
        convert: dict[str, Any] = {
            "text": str,
            "integer": int,
            "number": float,
            "decimal": Decimal,
            "datetime": datetime.fromisoformat,
            "date": date.fromisoformat,
        }
        return convert[self.kind](self.text)


class RowsByTime(msgspec.Struct, tag_field="by", tag="time", forbid_unknown_fields=True):
    """Every row before a time was read, and of those since then the ones that are marked."""

    since: StoredTime | None
    """None for a log that is shorter than the reorder window."""
    seen: list[str]


Bookmark = RowsById | RowsByTime


def mark_of(cells: Iterable[Any]) -> str:
    """A short text that tells rows apart."""
    text = "\x1f".join("" if cell is None else str(cell) for cell in cells)
    return blake2b(text.encode("utf-8", "surrogateescape"), digest_size=9).hexdigest()
