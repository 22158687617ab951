"""Findings and snapshots on disk, beside the model: `MODEL/findings.sqlite`.

This is the truth of live watching: what is published or copied elsewhere is read from here, and
`delivery` remembers how far each receiver has come.
"""

from __future__ import annotations

import sqlite3
from contextlib import closing
from typing import TYPE_CHECKING, NamedTuple

import msgspec

from runglight.nearest import nearest

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path
    from types import TracebackType

FILE_NAME = "findings.sqlite"

# `sequence` orders the lines of one id: a change of state is a further line.
_TABLES = """
CREATE TABLE IF NOT EXISTS finding (
    sequence INTEGER PRIMARY KEY AUTOINCREMENT,
    id TEXT NOT NULL,
    json TEXT NOT NULL
);
CREATE INDEX IF NOT EXISTS finding_id ON finding (id);
CREATE TABLE IF NOT EXISTS snapshot (
    id TEXT PRIMARY KEY ON CONFLICT REPLACE,
    json TEXT NOT NULL
);
CREATE TABLE IF NOT EXISTS delivery (
    receiver TEXT PRIMARY KEY ON CONFLICT REPLACE,
    sequence INTEGER NOT NULL
);
"""

_LINES_AT_ONCE = 250
"""Lines whose ids are looked up by one statement; SQLite takes no more than 999 parameters."""


class _Identified(msgspec.Struct):
    id: str


_identified = msgspec.json.Decoder(_Identified)


class Kept(NamedTuple):
    """One line of the store, in the order the lines were made."""

    sequence: int
    line: str
    snapshot: str | None
    """The snapshot that belongs to it, as JSON."""


class FindingStore:
    """Append findings, look the newest line of an id up, read on from a sequence number."""

    def __init__(
        self, model_directory: Path | None, *, create: bool = True, any_thread: bool = False
    ) -> None:
        """Opens the store; raises `sqlite3.Error` where it cannot be opened or made.

        Without a directory it lives in memory. `any_thread` is for an owner that sees to it
        that one thread at a time uses it.
        """
        self.path = None if model_directory is None else model_directory / FILE_NAME
        if create or self.path is None:
            self._connection = sqlite3.connect(
                self.path or ":memory:", timeout=10, check_same_thread=not any_thread
            )
            try:
                self._connection.execute("PRAGMA journal_mode=WAL")
                self._connection.executescript(_TABLES)
            except sqlite3.Error:
                self._connection.close()
                raise
        else:
            # Not `ro`: a reader of that kind cannot tidy the write-ahead log away when it ends.
            self._connection = sqlite3.connect(
                f"{self.path.resolve().as_uri()}?mode=rw",
                uri=True,
                timeout=10,
                check_same_thread=not any_thread,
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

    def append(
        self,
        json_lines: Iterable[str],
        snapshots: Iterable[str] = (),
        *,
        ids: Sequence[str] | None = None,
    ) -> None:
        """Writes findings and snapshots in one transaction; `ids` are the lines' own, where known.

        A line that is there already (the same log watched again) is not written again.
        """
        lines = list(json_lines)
        if ids is None:
            ids = [_identified.decode(line).id for line in lines]
        with self._connection:
            # Nobody else writes between the look for a line and its writing.
            self._connection.execute("BEGIN IMMEDIATE")
            self._append_new(lines, ids)
            self._connection.executemany(
                "INSERT INTO snapshot (id, json) VALUES (?, ?)",
                ((_identified.decode(text).id, text) for text in snapshots),
            )

    def _append_new(self, lines: Sequence[str], ids: Sequence[str]) -> None:
        """Writes the lines that are not there yet.

        A unique index over the JSON would hold every line again, and cost most of the writing;
        asking for each line alone would cost as much. So ids are looked up, many at once; and once
        a line is found, those that follow it mostly stand behind it, where they are read in order.
        """
        at = 0
        while at < len(lines):
            end = min(at + _LINES_AT_ONCE, len(lines))
            last = self._append_looked_up(lines[at:end], ids[at:end])
            at = end
            if last is not None:
                at += self._count_behind(last, lines[at:])

    def _append_looked_up(self, lines: Sequence[str], ids: Sequence[str]) -> int | None:
        """Writes those of a few lines that are not there; where the last stands if it was."""
        places = ",".join("?" * len(ids))
        there: dict[str, list[tuple[int | None, str]]] = {}
        for finding_id, sequence, line in self._connection.execute(
            f"SELECT id, sequence, json FROM finding WHERE id IN ({places})", ids
        ):
            there.setdefault(finding_id, []).append((sequence, line))
        new: list[tuple[str, str]] = []
        last: int | None = None
        for finding_id, line in zip(ids, lines, strict=True):
            of_this_id = there.setdefault(finding_id, [])
            for last, known in of_this_id:  # noqa: B007
                if known == line:
                    break
            else:
                last = None
                of_this_id.append((None, line))
                new.append((finding_id, line))
        self._connection.executemany("INSERT INTO finding (id, json) VALUES (?, ?)", new)
        return last

    def _count_behind(self, sequence: int, lines: Sequence[str]) -> int:
        """How many of the lines stand one after the other behind a sequence number."""
        behind = self._connection.execute(
            "SELECT json FROM finding WHERE sequence > ? ORDER BY sequence LIMIT ?",
            (sequence, len(lines)),
        )
        count = 0
        with closing(behind):
            for (known,), line in zip(behind, lines, strict=False):
                if known != line:
                    break
                count += 1
        return count

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

    def after(self, sequence: int, limit: int) -> list[Kept]:
        """The next lines after a sequence number, oldest first."""
        found = self._connection.execute(
            "SELECT f.sequence, f.json, s.json FROM finding f LEFT JOIN snapshot s"
            " ON s.id = json_extract(f.json, '$.snapshot_id')"
            " WHERE f.sequence > ? ORDER BY f.sequence LIMIT ?",
            (sequence, limit),
        )
        return [Kept(*row) for row in found]

    def last_sequence(self) -> int:
        """Sequence number of the newest line; 0 where there is none."""
        found = self._connection.execute("SELECT max(sequence) FROM finding").fetchone()
        return int(found[0] or 0)

    def delivered_to(self, receiver: str) -> int | None:
        """How far a receiver has come; None where it is new."""
        found = self._connection.execute(
            "SELECT sequence FROM delivery WHERE receiver = ?", (receiver,)
        ).fetchone()
        return None if found is None else int(found[0])

    def note_delivery(self, receiver: str, sequence: int) -> None:
        """Remembers that a receiver has everything up to a sequence number."""
        with self._connection:
            self._connection.execute(
                "INSERT INTO delivery (receiver, sequence) VALUES (?, ?)", (receiver, sequence)
            )

    def forget_before(self, sequence: int) -> int:
        """Drops lines before a sequence number (of a store in memory); returns how many."""
        with self._connection:
            dropped = self._connection.execute(
                "DELETE FROM finding WHERE sequence < ?", (sequence,)
            ).rowcount
            self._connection.execute(
                "DELETE FROM snapshot WHERE id NOT IN"
                " (SELECT json_extract(json, '$.snapshot_id') FROM finding"
                " WHERE json_extract(json, '$.snapshot_id') IS NOT NULL)"
            )
        return dropped
