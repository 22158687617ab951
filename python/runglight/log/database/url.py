"""Addresses of databases, and what may be said of them: never a password."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from sqlalchemy.engine import make_url
from sqlalchemy.exc import ArgumentError

from runglight.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sqlalchemy.engine import URL

EXAMPLES = "sqlite:///plant.db or postgresql://user@host/database"
# SQLAlchemy's own choice differs between its versions, or needs a compiler.
_DRIVERS = {
    "postgresql": "postgresql+psycopg",
    "mysql": "mysql+pymysql",
    "mariadb": "mariadb+pymysql",
}
_TIMED_DRIVERS = ("+psycopg", "+psycopg2", "+pymysql")
_CONNECT_TIMEOUT_S = 10


def database_url(text: str, option: str = "--sql") -> URL:
    """A URL with a driver chosen and a limit on connecting; InputError names `option`."""
    try:
        url = make_url(text)
    except (ArgumentError, ValueError):
        # What cannot be parsed is not repeated: a password may be in it.
        raise InputError(f"{option}: this is no database URL; write it like {EXAMPLES}") from None
    url = url.set(drivername=_DRIVERS.get(url.drivername, url.drivername))
    if url.drivername.endswith(_TIMED_DRIVERS) and "connect_timeout" not in url.query:
        url = url.update_query_dict({"connect_timeout": str(_CONNECT_TIMEOUT_S)})
    return url


def shown(url: URL) -> str:
    """The URL as people may see it: without password and query, which may hold one too."""
    return url.set(query={}).render_as_string(hide_password=True)


def place_of(url: URL) -> str:
    """Where the database is, whoever reads it: without user, and a file by its whole path."""
    database = url.database
    if url.get_backend_name() == "sqlite" and database and not database.startswith(":"):
        database = str(Path(database).resolve())
    # A server on a socket is told by it; everything else of the query may be a secret.
    sockets = {key: url.query[key] for key in ("host", "unix_socket") if key in url.query}
    return url.set(
        drivername=url.get_backend_name(),
        username=None,
        password=None,
        query=sockets,
        database=database,
    ).render_as_string(hide_password=True)


def reason(error: Exception, url: URL) -> str:
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
