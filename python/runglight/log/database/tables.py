"""Tables and views by the names that users write."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sqlalchemy import inspect

from runglight.errors import InputError
from runglight.log.database.url import shown
from runglight.nearest import suggestion

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from sqlalchemy import Connection
    from sqlalchemy.engine import URL


def found_table(connection: Connection, url: URL, asked: str | None) -> tuple[str | None, str]:
    """Schema and name of a table or view, as the database writes them."""
    inspector = inspect(connection)
    known = [*inspector.get_table_names(), *inspector.get_view_names()]
    if asked is None:
        raise InputError(f"{shown(url)}: which table? give --table{_listed(known)}")
    if found := as_written(asked, known):
        return None, found
    schema, dot, name = asked.rpartition(".")
    if dot and (place := as_written(schema, inspector.get_schema_names())):
        inside = [*inspector.get_table_names(place), *inspector.get_view_names(place)]
        if found := as_written(name, inside):
            return place, found
        known = [f"{place}.{each}" for each in inside]
    near = suggestion(asked, known) or _listed(known)
    raise InputError(f"{shown(url)}: there is no table {asked!r}{near}")


def as_written(asked: str, known: Iterable[str]) -> str | None:
    """The one of the known names that is meant, in any case where that is clear."""
    known = list(known)
    if asked in known:
        return asked
    alike = [each for each in known if each.casefold() == asked.casefold()]
    return alike[0] if len(alike) == 1 else None


def _listed(known: Sequence[str]) -> str:
    if not known:
        return "; the database has none"
    listed = ", ".join(sorted(known)[:8]) + (", …" if len(known) > 8 else "")
    return f"; there {'is' if len(known) == 1 else 'are'} {listed}"
