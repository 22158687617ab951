"""Findings and snapshots on disk, beside the model: `MODEL/findings.sqlite`."""

from __future__ import annotations

import json
import sqlite3
from typing import TYPE_CHECKING

from runglight.nearest import nearest

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path
    from types import TracebackType

FILE_NAME = "findings.sqlite"

# `sequence` orders the lines of one id: a change of state is a further line. A line that is
# there already (the same log watched again) is not written twice.
_TABLES = """
CREATE TABLE IF NOT EXISTS finding (
    sequence INTEGER PRIMARY KEY AUTOINCREMENT,
    id TEXT NOT NULL,
    json TEXT NOT NULL,
    UNIQUE (id, json) ON CONFLICT IGNORE
);
CREATE TABLE IF NOT EXISTS snapshot (
    id TEXT PRIMARY KEY ON CONFLICT REPLACE,
    json TEXT NOT NULL
);
"""


class FindingStore:
    """Append findings, look the newest line of an id up."""

    def __init__(self, model_directory: Path, *, create: bool = True) -> None:
        """Opens the store; raises `sqlite3.Error` where it cannot be opened or made."""
        self.path = model_directory / FILE_NAME
        if create:
            self._connection = sqlite3.connect(self.path, timeout=10)
            try:
                self._connection.execute("PRAGMA journal_mode=WAL")
                self._connection.executescript(_TABLES)
            except sqlite3.Error:
                self._connection.close()
                raise
        else:
            # Not `ro`: a reader of that kind cannot tidy the write-ahead log away when it ends.
            self._connection = sqlite3.connect(
                f"{self.path.resolve().as_uri()}?mode=rw", uri=True, timeout=10
            )

    def __enter__(self) -> FindingStore:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Closes the file."""
        self._connection.close()

    def append(self, json_lines: Iterable[str], snapshots: Iterable[str] = ()) -> None:
        """Writes findings and snapshots in one transaction."""
        with self._connection:
            self._connection.executemany(
                "INSERT INTO finding (id, json) VALUES (?, ?)",
                ((json.loads(line)["id"], line) for line in json_lines),
            )
            self._connection.executemany(
                "INSERT INTO snapshot (id, json) VALUES (?, ?)",
                ((json.loads(text)["id"], text) for text in snapshots),
            )

    def newest(self, finding_id: str) -> str | None:
        """The newest line of a finding, or None where the id is not known."""
        found = self._connection.execute(
            "SELECT json FROM finding WHERE id = ? ORDER BY sequence DESC LIMIT 1", (finding_id,)
        ).fetchone()
        return None if found is None else str(found[0])

    def snapshot(self, snapshot_id: str) -> str | None:
        """A snapshot's JSON."""
        found = self._connection.execute(
            "SELECT json FROM snapshot WHERE id = ?", (snapshot_id,)
        ).fetchone()
        return None if found is None else str(found[0])

    def nearest_ids(self, finding_id: str) -> list[str]:
        """The ids that resemble one that is not known; else the latest ones."""
        newest_first = [
            str(found[0])
            for found in self._connection.execute(
                "SELECT id FROM finding GROUP BY id ORDER BY max(sequence) DESC LIMIT 10000"
            )
        ]
        return nearest(finding_id, newest_first) or newest_first[:3]
