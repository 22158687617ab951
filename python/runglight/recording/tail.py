"""`tail.sqlite`: what was recorded since the last sealed segment, at most a fifth of a second old.

One row is one block. A commit is in the write-ahead log before it returns, so a killed process
loses nothing that was committed, and a power cut neither.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import msgspec

from runglight.errors import InputError
from runglight.recording.block import Block, DamagedBlockError, pack, unpack
from runglight.recording.layout import SEGMENTS, TAIL

BUSY_S = 10.0
_SCHEMA = """
CREATE TABLE IF NOT EXISTS block (
    id INTEGER PRIMARY KEY, until_ns INTEGER NOT NULL,
    row_count INTEGER NOT NULL, scan_count INTEGER NOT NULL, content BLOB NOT NULL
) STRICT;
CREATE TABLE IF NOT EXISTS state (key TEXT PRIMARY KEY, value INTEGER NOT NULL) STRICT;
"""


class TailState(msgspec.Struct):
    """Where recording stands; written with every commit."""

    last_block: int = 0
    """Number of the newest block, sealed or not."""
    sealed_block: int = 0
    """Up to this one, blocks are in segments."""
    segments: int = 0
    """Number of the last segment."""
    until_ns: int = 0
    """Everything up to here is recorded; 0 before the first block."""
    closed: int = 1
    """0 while a recorder is at work, and where it was killed."""


class Tail:
    """The recorder's connection; used by one thread at a time."""

    def __init__(self, directory: Path, state_of_new: TailState) -> None:
        self._path = directory / TAIL
        new = not self._path.exists()
        with _told(self._path):
            self._connection = sqlite3.connect(
                self._path, timeout=BUSY_S, isolation_level=None, check_same_thread=False
            )
            try:
                self._connection.execute("PRAGMA journal_mode=WAL")
                self._connection.execute("PRAGMA synchronous=FULL")
                self._connection.executescript(_SCHEMA)
                self.state = state_of_new if new else _read_state(self._connection, self._path)
                if not new:
                    _check(self._connection, self.state, self._path)
                with self._transaction():
                    self._keep(self.state)
            except BaseException:
                self._connection.close()
                raise

    def append(self, block: Block) -> None:
        """Commits one block."""
        state = msgspec.structs.replace(
            self.state, last_block=self.state.last_block + 1, until_ns=block.until_ns, closed=0
        )
        with self._transaction():
            self._connection.execute(
                "INSERT INTO block VALUES (?, ?, ?, ?, ?)",
                (
                    state.last_block,
                    block.until_ns,
                    len(block.time_ns),
                    len(block.scan_ns),
                    pack(block),
                ),
            )
            self._keep(state)
        self.state = state

    def advance(self, until_ns: int) -> None:
        """Commits that time went on to `until_ns` and nothing happened."""
        state = msgspec.structs.replace(self.state, until_ns=until_ns, closed=0)
        with self._transaction():
            self._keep(state)
        self.state = state

    def seal(self, number: int, last_block: int) -> None:
        """Forgets blocks that are in a segment: both happen, or neither."""
        state = msgspec.structs.replace(self.state, segments=number, sealed_block=last_block)
        with self._transaction():
            self._connection.execute("DELETE FROM block WHERE id <= ?", (last_block,))
            self._keep(state)
        self.state = state

    def close(self, *, ended_well: bool) -> None:
        """Says that the recorder ended well, where it did, and lets go of the file."""
        try:
            if ended_well:
                state = msgspec.structs.replace(self.state, closed=1)
                with self._transaction():
                    self._keep(state)
                self.state = state
        finally:
            self._connection.close()

    def unsealed(self) -> tuple[int, int]:
        """Rows and scans that are in no segment yet."""
        rows, scans = self._connection.execute(
            "SELECT coalesce(sum(row_count), 0), coalesce(sum(scan_count), 0) FROM block"
        ).fetchone()
        return rows, scans

    def _keep(self, state: TailState) -> None:
        self._connection.executemany(
            "INSERT OR REPLACE INTO state VALUES (?, ?)", msgspec.structs.asdict(state).items()
        )

    @contextmanager
    def _transaction(self) -> Iterator[None]:
        self._connection.execute("BEGIN IMMEDIATE")
        try:
            yield
            self._connection.execute("COMMIT")
        except BaseException:
            if self._connection.in_transaction:
                self._connection.execute("ROLLBACK")
            raise


def read_tail(
    directory: Path, *, up_to_block: int | None = None
) -> tuple[TailState, list[tuple[int, Block]]]:
    """State and numbered blocks as of one moment, also while a recorder is at work."""
    path = directory / TAIL
    with _told(path), closing(_reading(path)) as connection:
        connection.execute("BEGIN")
        state = _read_state(connection, path)
        _check(connection, state, path)
        rows = connection.execute(
            "SELECT id, content FROM block WHERE id <= ? ORDER BY id",
            (state.last_block if up_to_block is None else up_to_block,),
        ).fetchall()
    try:
        return state, [(number, unpack(content)) for number, content in rows]
    except DamagedBlockError as error:
        raise _damaged(path, str(error)) from None


def _reading(path: Path) -> sqlite3.Connection:
    address = path.resolve().as_uri()
    connection = None
    try:
        connection = sqlite3.connect(f"{address}?mode=ro", uri=True, timeout=BUSY_S)
        connection.execute("SELECT 1 FROM sqlite_master").fetchone()
    except sqlite3.OperationalError as error:
        if connection is not None:
            connection.close()
        journal = path.with_name(f"{path.name}-wal")
        if error.sqlite_errorcode & 0xFF not in {sqlite3.SQLITE_CANTOPEN, sqlite3.SQLITE_READONLY}:
            raise
        if journal.exists() and journal.stat().st_size:
            raise InputError(
                f"{path}: its write-ahead log cannot be read where nothing may be written; "
                "copy the whole recording to a place that is not read-only"
            ) from None
        # A read-only disk: nobody writes, so nothing need be watched.
        return sqlite3.connect(f"{address}?immutable=1", uri=True)
    return connection


def _read_state(connection: sqlite3.Connection, path: Path) -> TailState:
    written = dict(connection.execute("SELECT key, value FROM state"))
    try:
        state = msgspec.convert(written, TailState)
    except msgspec.ValidationError as error:
        raise _damaged(path, str(error)) from None
    if not 0 <= state.segments <= state.sealed_block <= state.last_block:
        raise _damaged(path, "its numbers contradict each other")
    return state


def _check(connection: sqlite3.Connection, state: TailState, path: Path) -> None:
    """Every block after the sealed ones is there, and the database's own pages agree."""
    [verdict] = connection.execute("PRAGMA quick_check(1)").fetchone()
    if verdict != "ok":
        raise _damaged(path, " ".join(str(verdict).split()))
    count, first, last = connection.execute(
        "SELECT count(*), min(id), max(id) FROM block"
    ).fetchone()
    expected = state.last_block - state.sealed_block
    if count != expected or (count and (first, last) != (state.sealed_block + 1, state.last_block)):
        raise _damaged(path, f"{count} blocks are there, {expected} were written")


def _damaged(path: Path, why: str) -> InputError:
    return InputError(
        f"{path}: is damaged ({why}); bring it back from a copy, or move {path.name} and what "
        f"begins with {path.name}- away: then what is in {SEGMENTS} is read"
    )


@contextmanager
def _told(path: Path) -> Iterator[None]:
    """SQLite's complaints about the file as one sentence."""
    try:
        yield
    except (sqlite3.DatabaseError, OverflowError) as error:
        code = getattr(error, "sqlite_errorcode", sqlite3.SQLITE_CORRUPT) & 0xFF
        if code in {sqlite3.SQLITE_FULL, sqlite3.SQLITE_IOERR}:
            raise InputError(
                f"{path}: the disk is full or fails ({error}); free some space and try again"
            ) from None
        if code in {sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED}:
            raise InputError(f"{path}: another program keeps it locked; close that") from None
        if code in {sqlite3.SQLITE_CANTOPEN, sqlite3.SQLITE_READONLY, sqlite3.SQLITE_PERM}:
            raise InputError(
                f"{path}: cannot be opened ({error}); check the rights of the file and its "
                "directory"
            ) from None
        raise _damaged(path, str(error)) from None
