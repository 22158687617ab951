"""Findings in a database of one's own: PostgreSQL or SQLite, through SQLAlchemy.

The tables are those of `findings.store`, with the columns a dashboard filters by beside the JSON.
"""

from __future__ import annotations

import datetime
import hashlib
import json
from typing import TYPE_CHECKING, Any

from sqlalchemy import (
    BigInteger,
    Column,
    DateTime,
    Index,
    Integer,
    MetaData,
    String,
    Table,
    Text,
    UniqueConstraint,
    create_engine,
    func,
    select,
)
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.engine import make_url
from sqlalchemy.exc import ArgumentError, SQLAlchemyError

from runglight.errors import InputError
from runglight.nearest import nearest

if TYPE_CHECKING:
    from collections.abc import Iterable

    from sqlalchemy import Engine
    from sqlalchemy.engine import URL

EXAMPLE = "postgresql://user@host/database or sqlite:///findings.db"
_TIMEOUT_S = 5

_tables = MetaData()
_FINDING = Table(
    "finding",
    _tables,
    Column(
        "sequence",
        BigInteger().with_variant(Integer, "sqlite"),
        primary_key=True,
        autoincrement=True,
    ),
    Column("id", String(64), nullable=False),
    Column("digest", String(64), nullable=False),
    Column("time", DateTime(timezone=True), nullable=False),
    Column("state", String(16), nullable=False),
    Column("severity", String(16), nullable=False),
    Column("kind", String(32), nullable=False),
    Column("incident", String(64), nullable=False),
    Column("group", Text),
    Column("device", Text),
    Column("signal", Text),
    Column("message", Text, nullable=False),
    Column("json", Text, nullable=False),
    # Of the JSON itself PostgreSQL's index could hold 2,700 bytes.
    UniqueConstraint("id", "digest"),
    Index("finding_time", "time"),
)
_SNAPSHOT = Table(
    "snapshot",
    _tables,
    Column("id", String(64), primary_key=True),
    Column("json", Text, nullable=False),
)


class DatabaseStore:
    """Findings in a database; the tables are made when they are first needed.

    Calls block for at most a few seconds, and raise `SQLAlchemyError` while the database is away;
    the next call connects anew.
    """

    def __init__(self, url: str) -> None:
        parsed = _parsed(url)
        self.name = parsed.render_as_string(hide_password=True)
        try:
            self._engine: Engine = create_engine(
                parsed, pool_pre_ping=True, pool_size=1, connect_args=_connect_arguments(parsed)
            )
        except ModuleNotFoundError as missing:
            raise InputError(
                f'--store {self.name}: needs {missing.name}: pip install "psycopg[binary]"'
            ) from None
        dialect = postgresql if parsed.get_backend_name() == "postgresql" else sqlite
        self._insert: Any = dialect.insert
        self._made = False

    def append(self, json_lines: Iterable[str], snapshots: Iterable[str] = ()) -> None:
        """Writes findings and snapshots in one transaction; what is there already stays once."""
        findings = [_row(line) for line in json_lines]
        pictures = [{"id": json.loads(text)["id"], "json": text} for text in snapshots]
        if not self._made:
            _tables.create_all(self._engine)
            self._made = True
        with self._engine.begin() as connection:
            if findings:
                connection.execute(self._insert(_FINDING).on_conflict_do_nothing(), findings)
            if pictures:
                connection.execute(self._insert(_SNAPSHOT).on_conflict_do_nothing(), pictures)

    def newest(self, finding_id: str) -> str | None:
        """The newest line of a finding, or None where the id is not known."""
        newest = (
            select(_FINDING.c.json)
            .where(_FINDING.c.id == finding_id)
            .order_by(_FINDING.c.sequence.desc())
            .limit(1)
        )
        with self._engine.connect() as connection:
            return connection.scalar(newest)

    def snapshot(self, snapshot_id: str) -> str | None:
        """A snapshot's JSON."""
        with self._engine.connect() as connection:
            return connection.scalar(select(_SNAPSHOT.c.json).where(_SNAPSHOT.c.id == snapshot_id))

    def nearest_ids(self, finding_id: str) -> list[str]:
        """The ids that resemble one that is not known; else the latest ones."""
        latest = (
            select(_FINDING.c.id)
            .group_by(_FINDING.c.id)
            .order_by(func.max(_FINDING.c.sequence).desc())
            .limit(10_000)
        )
        with self._engine.connect() as connection:
            newest_first = [str(found) for found in connection.scalars(latest)]
        return nearest(finding_id, newest_first) or newest_first[:3]

    def close(self) -> None:
        """Closes the connections."""
        self._engine.dispose()


def reason(error: SQLAlchemyError) -> str:
    """What the database said, in one line, without the statement and its values."""
    said = str(getattr(error, "orig", None) or error).strip()
    return said.splitlines()[0] if said else type(error).__name__


def _parsed(url: str) -> URL:
    try:
        parsed = make_url(url)
    except (ArgumentError, ValueError):
        # What cannot be parsed is not repeated: a password may be in it.
        raise InputError(f"--store: this is no database URL; write it like {EXAMPLE}") from None
    if parsed.drivername == "postgresql":
        parsed = parsed.set(drivername="postgresql+psycopg")
    if parsed.get_backend_name() not in {"postgresql", "sqlite"}:
        raise InputError(
            f"--store: findings cannot be kept in {parsed.get_backend_name()}; "
            f"write it like {EXAMPLE}"
        )
    return parsed


def _connect_arguments(url: URL) -> dict[str, object]:
    if url.get_backend_name() == "sqlite":
        return {"timeout": _TIMEOUT_S, "check_same_thread": False}
    return {
        "connect_timeout": _TIMEOUT_S,
        # A server that vanished without a word is noticed as well.
        "tcp_user_timeout": _TIMEOUT_S * 1000,
        "application_name": "runglight",
        "options": f"-c statement_timeout={_TIMEOUT_S * 1000}",
    }


def _row(line: str) -> dict[str, Any]:
    finding: dict[str, Any] = json.loads(line)
    columns = ("id", "state", "severity", "kind", "incident", "group", "device", "signal")
    return {
        **{name: finding.get(name) for name in columns},
        "message": finding.get("message") or "",
        "time": datetime.datetime.fromisoformat(finding["time"]),
        "digest": hashlib.sha256(line.encode()).hexdigest(),
        "json": line,
    }
