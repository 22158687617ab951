"""Findings in a real PostgreSQL, and in SQLite through the same store."""

import asyncio
import json
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from sqlalchemy import create_engine, text
from sqlalchemy.exc import SQLAlchemyError

from runglight.errors import InputError
from runglight.findings.database_store import DatabaseStore
from runglight.findings.seam import Store
from runglight.findings.store import FindingStore
from runglight.live.database import DatabaseCopy
from runglight.log.changelog import Log
from runglight.model import NominalModel
from tests.conftest import simulated
from tests.findings.postgresql import PostgreSql
from tests.live.double_tap import batch_of
from tests.live.running import Watching, until


@pytest.fixture(scope="module")
def postgresql() -> Iterator[PostgreSql]:
    # Not pytest's own directory: the user postgres may not enter that.
    directory = Path(tempfile.mkdtemp(prefix="runglight-postgresql-"))
    directory.chmod(0o755)
    try:
        server = PostgreSql(directory)
        server.start()
        yield server
        server.stop()
    finally:
        shutil.rmtree(directory, ignore_errors=True)


@pytest.fixture(params=["beside the model", "sqlite", "postgresql"])
def store(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Store]:
    """Every store there is, empty."""
    if request.param == "beside the model":
        opened: Store = FindingStore(tmp_path)
    elif request.param == "sqlite":
        opened = DatabaseStore(f"sqlite:///{tmp_path / 'findings.db'}")
    else:
        url = request.getfixturevalue("postgresql").url
        opened = DatabaseStore(url)
        emptied(url)
    yield opened
    opened.close()


def emptied(url: str) -> None:
    engine = create_engine(url.replace("postgresql:", "postgresql+psycopg:"))
    with engine.begin() as connection:
        connection.execute(text("DROP TABLE IF EXISTS finding, snapshot"))
    engine.dispose()


def line(finding_id: str, state: str, message: str = "it is so") -> str:
    finding = {"id": finding_id, "incident": finding_id, "time": "2026-01-05T06:05:13.123456789Z"}
    finding |= {"state": state, "severity": "fault", "kind": "late", "message": message}
    return json.dumps(finding)


def test_every_store_keeps_lines_once_and_in_order(store: Store) -> None:
    for _ in range(2):
        store.append(
            [line("a", "suspected"), line("b", "suspected"), line("a", "returned")],
            [json.dumps({"id": "s"})],
        )
    assert store.newest("a") == line("a", "returned")
    assert store.newest("b") == line("b", "suspected")
    assert store.newest("c") is None
    assert store.snapshot("s") == json.dumps({"id": "s"})
    assert store.snapshot("t") is None
    assert store.nearest_ids("zzz") == ["a", "b"]


def test_long_findings_fit(store: Store) -> None:
    long = line("a", "suspected", "x" * 100_000)
    store.append([long])
    store.append([long])
    assert store.newest("a") == long


def test_a_dashboard_can_filter(postgresql: PostgreSql) -> None:
    emptied(postgresql.url)
    store = DatabaseStore(postgresql.url)
    store.append([line("a", "suspected")])
    store.close()
    engine = create_engine(postgresql.url.replace("postgresql:", "postgresql+psycopg:"))
    with engine.connect() as connection:
        row = connection.execute(
            text("SELECT extract(epoch FROM time), severity, state, message FROM finding")
        ).one()
    engine.dispose()
    assert (float(row[0]), *row[1:]) == (1767593113.123456, "fault", "suspected", "it is so")


def test_a_database_that_was_away_is_caught_up(
    postgresql: PostgreSql, nominal_model: NominalModel, cell: Path, tmp_path: Path
) -> None:
    emptied(postgresql.url)
    faulty: Log = simulated(seed=2, fault=1)
    directory = tmp_path / "cell.model"
    shutil.copytree(cell / "cell.model", directory)

    async def main() -> list[str]:
        watching = Watching(nominal_model, directory, faulty)
        copy = DatabaseCopy(postgresql.url)
        run = asyncio.create_task(watching.session.run([copy]))
        postgresql.stop()
        watching.tap.feed(batch_of(faulty, 0, len(faulty)))
        await until(lambda: any("takes no findings" in each for each in watching.said))
        assert watching.told
        postgresql.start()
        await until(lambda: any("takes findings again" in each for each in watching.said))
        watching.session.stop()
        await run
        return watching.told

    told = asyncio.run(main())
    engine = create_engine(postgresql.url.replace("postgresql:", "postgresql+psycopg:"))
    with engine.connect() as connection:
        lines = connection.execute(text("SELECT json FROM finding ORDER BY sequence")).scalars()
        assert list(lines) == told
        snapshots = connection.execute(text("SELECT count(*) FROM snapshot")).scalar_one()
        assert snapshots > 0
    engine.dispose()


def test_a_server_that_is_away_raises_and_is_used_when_it_is_back(postgresql: PostgreSql) -> None:
    store = DatabaseStore(postgresql.url)
    store.append([line("before", "suspected")])
    postgresql.stop()
    with pytest.raises(SQLAlchemyError):
        store.append([line("after", "suspected")])
    postgresql.start()
    store.append([line("after", "suspected")])
    assert store.newest("before") is not None
    assert store.newest("after") is not None
    store.close()


@pytest.mark.parametrize(
    ("url", "says"),
    [
        ("nonsense", "this is no database URL"),
        ("mysql://root:secret@host/db", "cannot be kept in mysql"),
    ],
)
def test_what_is_no_such_database_is_refused(url: str, says: str) -> None:
    with pytest.raises(InputError, match=says) as refused:
        DatabaseStore(url)
    assert "secret" not in str(refused.value)


def test_a_password_is_not_shown() -> None:
    store = DatabaseStore("postgresql://me:secret@127.0.0.1:9/db")
    assert store.name == "postgresql+psycopg://me:***@127.0.0.1:9/db"
    with pytest.raises(SQLAlchemyError) as failed:
        store.newest("a")
    assert "secret" not in str(failed.value)
    store.close()
