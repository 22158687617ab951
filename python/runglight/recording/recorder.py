"""The recorder: takes a tap's batches and has them on the disk a fifth of a second later.

`append` only queues. A thread commits what is queued as one block, and a second one turns what has
gathered in the tail into sealed segments, so that neither a slow disk nor a large segment holds up
the tap or the commits.
"""

from __future__ import annotations

import sqlite3
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Protocol, Self

from runglight.errors import InputError
from runglight.recording import disk, place
from runglight.recording.block import Block
from runglight.recording.lock import DirectoryLock
from runglight.recording.numbering import Numbering
from runglight.recording.segment import seal
from runglight.recording.session import Session
from runglight.recording.tail import Tail
from runglight.taps.base import Batch, TapSignal

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


class Tapped(Protocol):
    """What a recorder must know of a `Tap`."""

    @property
    def url(self) -> str:
        """Where it taps, without secrets."""

    @property
    def signals(self) -> list[TapSignal]:
        """Grows only."""

    @property
    def interval_ns(self) -> int | None:
        """Wanted time between two scans."""


class Recorder:
    """Writes one recording; InputError where another recorder does, or where it cannot.

    A directory that is a recording is gone on with: the time between is a gap.
    """

    def __init__(
        self,
        directory: Path,
        tap: Tapped,
        *,
        reserve_bytes: int = disk.RESERVE_BYTES,
        seal_at: SealAt | None = None,
    ) -> None:
        self.directory = directory
        self.rows = 0
        """Rows taken by this recorder, committed or not."""
        self.scans = 0
        self.until_ns = 0
        """Up to here everything is on the disk."""
        self._tap = tap
        self._reserve_bytes = reserve_bytes
        self._seal_at = seal_at or SealAt()
        place.prepare(directory)
        try:
            self._lock = DirectoryLock(directory)
        except OSError as error:
            raise disk.stopped(directory, error, 0) from None
        try:
            place.sweep(directory)
            disk.check_reserve(directory, reserve_bytes, 0)
            self._description = place.described(directory, tap.url, tap.interval_ns)
            self._signals = tap.signals
            self._numbering = Numbering(directory, self._description, self._signals)
            self._tail = Tail(directory, place.state_of_segments(directory))
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

    def append(self, batch: Batch) -> None:
        """Takes a batch; InputError where recording had to stop (what was there is kept)."""
        self.check()
        if self._closed:
            raise ValueError("the recorder is closed")
        taken = self._session.taken(batch)
        # Looked at in the tap's own thread, and before the batch that may count on it.
        self._signals = self._tap.signals
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
        block = Block.of(batches, self._numbering.numbers(self._signals))
        if told_something:
            self._tail.append(block)
        else:
            self._tail.advance(block.until_ns)
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
