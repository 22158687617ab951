"""Connections that only read, tell what is wrong in one sentence, and hold no locks for long."""

from __future__ import annotations

from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from sqlalchemy import create_engine
from sqlalchemy.exc import NoSuchModuleError, SQLAlchemyError
from sqlalchemy.pool import NullPool

from runglight.errors import InputError
from runglight.log.database.url import EXAMPLES, reason, shown
from runglight.nearest import suggestion

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sqlalchemy import Connection
    from sqlalchemy.engine import URL

_DATABASES = ("sqlite", "postgresql", "mysql", "mariadb", "mssql", "oracle")
_PACKAGES = {
    "psycopg": '"psycopg[binary]"',
    "psycopg2": "psycopg2-binary",
    "MySQLdb": "mysqlclient",
    "pymysql": "PyMySQL",
}
# Said once to the session, so that it holds for every transaction of it. MySQL and MariaDB give
# TIMESTAMP columns in the session's zone and without naming it.
_READ_ONLY = {
    "sqlite": ("PRAGMA query_only = ON",),
    "postgresql": ("SET SESSION CHARACTERISTICS AS TRANSACTION READ ONLY",),
    "mysql": ("SET SESSION TRANSACTION READ ONLY", "SET time_zone = '+00:00'"),
    "mariadb": ("SET SESSION TRANSACTION READ ONLY", "SET time_zone = '+00:00'"),
}


class DatabaseUnavailableError(InputError):
    """The database cannot be reached now, or went away; it may come back."""


@contextmanager
def connected(url: URL) -> Iterator[Connection]:
    """A connection to read by; whatever the driver raises becomes an InputError."""
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
            f"{shown(url)}: its driver {driver} is not installed: "
            f"pip install {_PACKAGES.get(driver, driver)}"
        ) from None
    except Exception as error:  # A driver may raise what it likes.
        raise DatabaseUnavailableError(
            f"{shown(url)}: cannot connect: {reason(error, url)}; check address, user and password"
        ) from None
    try:
        with connection:
            for statement in _READ_ONLY.get(url.get_backend_name(), ()):
                connection.exec_driver_sql(statement)
            connection.commit()
            yield connection
    except SQLAlchemyError as error:
        gone = bool(getattr(error, "connection_invalidated", False)) or "locked" in str(error)
        raise (DatabaseUnavailableError if gone else InputError)(
            f"{shown(url)}: cannot read: {reason(error, url)}"
        ) from None


def _refuse_missing_file(url: URL) -> None:
    # SQLite would make an empty database.
    file = url.database
    if url.get_backend_name() != "sqlite" or not file or file.startswith((":memory:", "file:")):
        return
    if not Path(file).is_file():
        raise InputError(f"{file}: there is no such SQLite file; check the path in --sql")
