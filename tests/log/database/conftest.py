"""Every kind of database that is tested, each with a database of its own for a test."""

import itertools
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.log.database.servers import mariadb_server, postgresql_server

sqlalchemy = pytest.importorskip("sqlalchemy")
_numbers = itertools.count()


@pytest.fixture(scope="session")
def postgresql() -> Iterator[str]:
    """The URL of a PostgreSQL server of our own."""
    with postgresql_server() as url:
        yield url


@pytest.fixture(scope="session")
def mariadb() -> Iterator[str]:
    """The URL of a MariaDB server of our own."""
    with mariadb_server() as url:
        yield url


@pytest.fixture(params=["sqlite", "postgresql", "mariadb"])
def database(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """The URL of an empty database."""
    if request.param == "sqlite":
        path = tmp_path / "plant.db"
        path.touch()
        return f"sqlite:///{path}"
    from runglight.log.database.url import database_url  # noqa: PLC0415

    server = database_url(request.getfixturevalue(request.param))
    name = f"plant_{next(_numbers)}"
    engine = sqlalchemy.create_engine(
        server, isolation_level="AUTOCOMMIT", poolclass=sqlalchemy.NullPool
    )
    with engine.connect() as connection:
        connection.exec_driver_sql(f"CREATE DATABASE {name}")
    return str(server.set(database=name).render_as_string(hide_password=False))
