"""The recorder: takes a tap's batches and has them on the disk a fifth of a second later.

`append` only queues. A thread commits what is queued as one block, and a second one turns what has
gathered in the tail into sealed segments, so that neither a slow disk nor a large segment holds up
the tap or the commits.
"""

from __future__ import annotations

import sqlite3
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Self

from runglight.errors import InputError
from runglight.moments import iso
from runglight.recording import disk
from runglight.recording.block import Block
from runglight.recording.description import (
    FORMAT,
    Description,
    read_description,
    write_description,
)
from runglight.recording.layout import (
    DESCRIPTION,
    LOCK,
    PHOTOS,
    SEGMENTS,
    is_recording,
    sealed_numbers,
)
from runglight.recording.lock import DirectoryLock
from runglight.recording.numbering import Numbering, Rename
from runglight.recording.segment import read_head, seal
from runglight.recording.session import Session
from runglight.recording.tail import Tail, TailState
from runglight.taps.base import Batch, Tap, TapSignal

COMMIT_S = 0.2
QUIET_COMMIT_S = 1.0
"""How long nothing but the passing of time waits for its commit."""
SEAL_AGAIN_S = 60.0
"""After a segment could not be written, the tail keeps all for this long until the next try."""


@dataclass(frozen=True, slots=True)
class SealAt:
    """When the tail becomes a segment: whichever comes first."""

    rows: int = 1_000_000
    scans: int = 2_000_000
    age_s: float = 600.0


class Recorder:
    """Writes one recording; InputError where another recorder does, or where it cannot.

    `signals` is the tap's own list, which may go on growing. A directory that is a recording is
    gone on with: the time between is a gap.
    """

    def __init__(
        self,
        directory: Path,
        *,
        signals: Sequence[TapSignal],
        source: str,
        interval_ns: int | None = None,
        rename: Rename | None = None,
        reserve_bytes: int = disk.RESERVE_BYTES,
        seal_at: SealAt | None = None,
    ) -> None:
        self.directory = directory
        self.rows = 0
        """Rows taken by this recorder, committed or not."""
        self.scans = 0
        self.until_ns = 0
        """Up to here everything is on the disk."""
        self._reserve_bytes = reserve_bytes
        self._seal_at = seal_at or SealAt()
        _prepare(directory)
        try:
            self._lock = DirectoryLock(directory)
        except OSError as error:
            raise disk.stopped(directory, error, 0) from None
        try:
            _sweep(directory)
            disk.check_reserve(directory, reserve_bytes, 0)
            self._description = _described(directory, source, interval_ns)
            self._numbering = Numbering(directory, self._description, signals, rename)
            self._tail = Tail(directory, _state_of_segments(directory))
        except (sqlite3.Error, OSError) as error:
            self._lock.release()
            raise disk.stopped(directory, error, 0) from None
        except BaseException:
            self._lock.release()
            raise
        self.until_ns = self._tail.state.until_ns
        self._session = Session(self._tail.state)
        self._queue: list[Batch] = []
        self._queue_lock = threading.Lock()
        self._unsealed_rows, self._unsealed_scans = self._tail.unsealed()
        self._unsealed_since = self._committed = time.monotonic()
        self._may_seal_from = 0.0
        self._sealing: Future[tuple[int, int]] | None = None
        self._failure: Exception | None = None
        self._told = False
        self._closed = False
        self._closing = threading.Event()
        self._sealer = ThreadPoolExecutor(1, "runglight-sealer")
        self._writer = threading.Thread(target=self._run, name="runglight-recorder", daemon=True)
        self._writer.start()

    @classmethod
    def of(
        cls,
        tap: Tap,
        directory: Path,
        *,
        rename: Rename | None = None,
        reserve_bytes: int = disk.RESERVE_BYTES,
    ) -> Self:
        """A recorder of what a tap gives."""
        return cls(
            directory,
            signals=tap.signals,
            source=tap.url,
            interval_ns=tap.interval_ns,
            rename=rename,
            reserve_bytes=reserve_bytes,
        )

    def append(self, batch: Batch) -> None:
        """Takes a batch; InputError where recording had to stop (what was there is kept)."""
        self.check()
        if self._closed:
            raise ValueError("the recorder is closed")
        taken = self._session.taken(batch)
        with self._queue_lock:
            self._queue.append(taken)
        self.rows += len(batch)
        self.scans += len(batch.scan_ns)

    def check(self) -> None:
        """Raises InputError where recording had to stop, for those who have nothing to append."""
        if self._failure is not None:
            self._told = True
            raise self._failure

    def close(self) -> None:
        """Commits and seals what is there; may be called twice. Raises as `append` does."""
        if self._closed:
            return
        self._closed = True
        self._closing.set()
        self._writer.join()
        try:
            if self._failure is None:
                self._guarded(self._finish)
        finally:
            self._sealer.shutdown()
            try:
                self._tail.close(ended_well=self._failure is None)
            except (sqlite3.Error, OSError) as error:
                # Everything was committed before; only the last word is missing.
                self._failure = self._failure or disk.stopped(self.directory, error, self.until_ns)
            self._lock.release()
        if not self._told:
            self.check()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        try:
            self.close()
        except InputError:
            if error is None:
                raise

    @property
    def free_bytes(self) -> int:
        """What is free on the recording's disk."""
        return disk.free_bytes(self.directory)

    def _run(self) -> None:
        while not self._closing.wait(COMMIT_S) and self._failure is None:
            self._guarded(self._step)

    def _guarded(self, step: Callable[[], None]) -> None:
        """Keeps what goes wrong for the caller's thread, in words."""
        try:
            step()
        except (sqlite3.Error, OSError) as error:
            self._failure = disk.stopped(self.directory, error, self.until_ns)
        except Exception as error:
            self._failure = error

    def _step(self) -> None:
        disk.check_reserve(self.directory, self._reserve_bytes, self.until_ns)
        self._commit(quiet_s=QUIET_COMMIT_S)
        self._end_sealing(wait=False)
        if self._sealing is None and self._is_due() and time.monotonic() >= self._may_seal_from:
            self._begin_sealing()

    def _finish(self) -> None:
        self._commit(quiet_s=0.0)
        self._end_sealing(wait=True)
        if self._unsealed_rows + self._unsealed_scans:
            self._begin_sealing()
            self._end_sealing(wait=True)

    def _commit(self, quiet_s: float) -> None:
        with self._queue_lock:
            batches, self._queue = self._queue, []
        if not batches:
            return
        told_something = any(len(b) or len(b.scan_ns) or b.marks for b in batches)
        if not told_something and time.monotonic() - self._committed < quiet_s:
            with self._queue_lock:
                self._queue[:0] = batches[-1:]
            return
        block = Block.of(batches, self._numbering.numbers())
        self._tail.append(block)
        self._committed = time.monotonic()
        self.until_ns = block.until_ns
        self._unsealed_rows += len(block.time_ns)
        self._unsealed_scans += len(block.scan_ns)

    def _is_due(self) -> bool:
        if not self._unsealed_rows + self._unsealed_scans:
            self._unsealed_since = time.monotonic()
            return False
        return (
            self._unsealed_rows >= self._seal_at.rows
            or self._unsealed_scans >= self._seal_at.scans
            or time.monotonic() - self._unsealed_since >= self._seal_at.age_s
        )

    def _begin_sealing(self) -> None:
        number, last_block = self._tail.state.segments + 1, self._tail.state.last_block
        names, interval_ns = self._numbering.names, self._description.interval_ns

        def write() -> tuple[int, int]:
            seal(self.directory, number, last_block, names, interval_ns)
            return number, last_block

        self._unsealed_since = time.monotonic()
        self._sealing = self._sealer.submit(write)

    def _end_sealing(self, *, wait: bool) -> None:
        if self._sealing is None or not (wait or self._sealing.done()):
            return
        sealing, self._sealing = self._sealing, None
        try:
            number, last_block = sealing.result()
        except (InputError, sqlite3.Error, OSError):
            # No loss: the blocks stay in the tail. A full disk is found by the reserve.
            self._may_seal_from = time.monotonic() + SEAL_AGAIN_S
            return
        self._tail.seal(number, last_block)
        self._unsealed_rows, self._unsealed_scans = self._tail.unsealed()


def _prepare(directory: Path) -> None:
    """A place for a recording: new, empty, or a recording; InputError for anything else."""
    if directory.exists() and not directory.is_dir():
        raise InputError(f"{directory}: is a file; name a directory to record to")
    try:
        if directory.is_dir() and not is_recording(directory):
            # What a recorder leaves that was killed before it described anything is no hindrance.
            ours = (LOCK, SEGMENTS, f".{DESCRIPTION}.")
            if any(not path.name.startswith(ours) for path in directory.iterdir()):
                raise InputError(
                    f"{directory}: is not empty and no recording; name another directory"
                )
        (directory / SEGMENTS).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise disk.stopped(directory, error, 0) from None


def _sweep(directory: Path) -> None:
    """Takes away the temporary files of a recorder that was killed."""
    for place, names in ((directory, f".{DESCRIPTION}.*"), (SEGMENTS, ".*"), (PHOTOS, ".*")):
        for path in (directory / place).glob(names):
            path.unlink()


def _described(directory: Path, source: str, interval_ns: int | None) -> Description:
    """The description there is, brought up to date, or a new one."""
    if is_recording(directory):
        description = read_description(directory)
        if (description.source, description.interval_ns) == (source, interval_ns):
            return description
        description.source, description.interval_ns = source, interval_ns
    else:
        created = iso(time.time_ns())
        description = Description(FORMAT, created, source, interval_ns)
    write_description(directory, description)
    return description


def _state_of_segments(directory: Path) -> TailState:
    """Where recording stands if there is no tail: after the segments."""
    numbers = sealed_numbers(directory)
    if not numbers:
        return TailState()
    head = read_head(directory, numbers[-1])
    # Every segment has at least one block, whose numbers go on.
    return TailState(head.number, head.number, head.number, head.until_ns)
