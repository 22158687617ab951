"""What operators did about incidents, and who and when: kept beside the findings.

The words are those of ISA-18.2: an alarm is acknowledged when somebody has seen it, and shelved
when it shall be quiet for a time.
"""

from __future__ import annotations

import sqlite3
from typing import TYPE_CHECKING, Literal

import msgspec

from runglight.findings.store import FILE_NAME

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

Deed = Literal["acknowledge", "shelve", "unshelve", "accept"]

_TABLE = """
CREATE TABLE IF NOT EXISTS act (
    sequence INTEGER PRIMARY KEY AUTOINCREMENT,
    incident TEXT NOT NULL,
    deed TEXT NOT NULL,
    who TEXT NOT NULL,
    time TEXT NOT NULL,
    until TEXT
);
"""


class Act(msgspec.Struct, frozen=True):
    """One deed of an operator."""

    incident: str
    deed: Deed
    who: str
    time: str
    """ISO 8601, UTC, by the clock of this computer."""
    until: str | None = None
    """Shelved up to here."""


class Acts:
    """The acts of one store; used by one thread at a time. Raises `sqlite3.Error`."""

    def __init__(self, model_directory: Path | None) -> None:
        path = ":memory:" if model_directory is None else str(model_directory / FILE_NAME)
        self._connection = sqlite3.connect(path, timeout=10, check_same_thread=False)
        try:
            self._connection.execute("PRAGMA journal_mode=WAL")
            self._connection.executescript(_TABLE)
        except sqlite3.Error:
            self._connection.close()
            raise

    def append(self, acts: Iterable[Act]) -> None:
        """Writes acts in one transaction."""
        with self._connection:
            self._connection.executemany(
                "INSERT INTO act (incident, deed, who, time, until) VALUES (?, ?, ?, ?, ?)",
                ((act.incident, act.deed, act.who, act.time, act.until) for act in acts),
            )

    def all(self) -> list[Act]:
        """Every act, the oldest first."""
        rows = self._connection.execute(
            "SELECT incident, deed, who, time, until FROM act ORDER BY sequence"
        )
        return [Act(*row) for row in rows]

    def close(self) -> None:
        """Closes the file."""
        self._connection.close()
