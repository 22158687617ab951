"""Keeps findings: one thread writes the store and reads from it for those who pass them on."""

from __future__ import annotations

import asyncio
import sqlite3
import time
from collections import deque
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, TypeVar

from runglight.findings.store import FindingStore, Kept

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from runglight.live.delivery import Receiver

Result = TypeVar("Result")

LINES_IN_MEMORY = 100_000
"""Findings held while the disk takes none; the oldest go first, and are counted."""
RETRY_DISK_S = 10.0


class Keeper:
    """The store of one session, never waited for by the monitor.

    Where the disk takes nothing (full, read-only, gone), findings are held in memory, so that they
    are still published, and written as soon as the disk takes them again. Receivers may be given
    some of those twice; lines and their ids stay the same.
    """

    def __init__(self, model_directory: Path | None, say: Callable[[str], None]) -> None:
        # Without a directory, findings live in memory.
        self._directory = model_directory
        self._say = say
        self._thread = ThreadPoolExecutor(1, "findings")
        self._new: deque[tuple[list[str], list[str]]] = deque()
        self._wake = asyncio.Event()
        self._more = asyncio.Condition()
        self._disk: FindingStore | None = None
        self._memory: FindingStore | None = None
        self._retry_disk_at_s = 0.0
        self._cursors: dict[str, int] = {}
        self._closing = False
        self.dropped = 0
        """Findings lost because the disk took nothing for too long."""

    async def open(self, receivers: Sequence[Receiver] = ()) -> None:
        """Opens the store, and finds the place of each receiver in it."""
        await self._in_thread(self._reopen)
        for receiver in receivers:
            if not receiver.from_the_start:
                await self._in_thread(self._begin, receiver.name)

    @property
    def on_disk(self) -> bool:
        """False while findings are only in memory."""
        return self._disk is not None

    def put(self, lines: list[str], snapshots: list[str]) -> None:
        """Hands findings over; returns at once."""
        self._new.append((lines, snapshots))
        self._wake.set()

    async def run(self) -> None:
        """Writes what is put, until cancelled."""
        while not self._closing:
            try:
                async with asyncio.timeout(RETRY_DISK_S):
                    await self._wake.wait()
            except TimeoutError:
                pass
            await self.flush()

    async def flush(self) -> None:
        """Writes everything that has been put; it is on disk when this returns, if that can be."""
        self._wake.clear()
        if self._disk is None and time.monotonic() >= self._retry_disk_at_s:
            await self._in_thread(self._reopen)
        if not self._new:
            return
        lines: list[str] = []
        snapshots: list[str] = []
        while self._new:
            some_lines, some_snapshots = self._new.popleft()
            lines += some_lines
            snapshots += some_snapshots
        await self._in_thread(self._append, lines, snapshots)
        async with self._more:
            self._more.notify_all()

    async def next(self, receiver: str, limit: int) -> list[Kept]:
        """The lines a receiver has not had yet; waits until there are some."""
        while True:
            if found := await self._in_thread(self._after, receiver, limit):
                return found
            async with self._more:
                # Looked at again now and then: lines may have come between the two awaits.
                try:
                    async with asyncio.timeout(1.0):
                        await self._more.wait()
                except TimeoutError:
                    continue

    async def delivered(self, receiver: str, sequence: int) -> None:
        """A receiver has everything up to here."""
        await self._in_thread(self._note, receiver, sequence)

    async def behind(self, receiver: str) -> int:
        """Sequence numbers a receiver has yet to be given."""
        return await self._in_thread(self._behind, receiver)

    async def close(self) -> None:
        """Writes the rest and closes the file."""
        self._closing = True
        await self.flush()
        await self._in_thread(self._close)
        self._thread.shutdown()

    async def _in_thread(self, work: Callable[..., Result], *arguments: object) -> Result:
        # Shielded: work that is queued when its asker is cancelled would not be done.
        working = asyncio.get_running_loop().run_in_executor(self._thread, work, *arguments)
        return await asyncio.shield(working)

    # All below runs in the thread.

    def _store(self) -> FindingStore:
        if self._disk is not None:
            return self._disk
        if self._memory is None:
            self._memory = FindingStore(None, any_thread=True)
            self._cursors.clear()
        return self._memory

    def _reopen(self) -> None:
        try:
            disk = FindingStore(self._directory, any_thread=True)
            if self._memory is not None:
                held = self._memory.after(0, LINES_IN_MEMORY)
                disk.append(
                    (kept.line for kept in held),
                    (kept.snapshot for kept in held if kept.snapshot is not None),
                )
                self._memory.close()
                self._memory = None
                self._cursors.clear()
                self._say(f"{self._directory}: findings are kept on disk again")
        except (sqlite3.Error, OSError) as error:
            self._lose_disk(error)
        else:
            self._disk = disk

    def _lose_disk(self, error: Exception) -> None:
        if self._disk is not None:
            self._disk.close()
            self._disk = None
        if self._memory is None:
            self._say(
                f"{self._directory}: findings cannot be kept here ({error}); they are held in "
                "memory until they can. Free some space, or make the directory writable"
            )
        self._store()
        self._retry_disk_at_s = time.monotonic() + RETRY_DISK_S

    def _append(self, lines: list[str], snapshots: list[str]) -> None:
        try:
            self._store().append(lines, snapshots)
        except (sqlite3.Error, OSError) as error:
            self._lose_disk(error)
            self._store().append(lines, snapshots)
        if self._memory is not None:
            first = self._memory.last_sequence() - LINES_IN_MEMORY + 1
            if first > 1:
                self.dropped += self._memory.forget_before(first)

    def _begin(self, receiver: str) -> None:
        store = self._store()
        if store.delivered_to(receiver) is None:
            self._note(receiver, store.last_sequence())

    def _cursor(self, receiver: str) -> int:
        if receiver not in self._cursors:
            self._cursors[receiver] = self._store().delivered_to(receiver) or 0
        return self._cursors[receiver]

    def _after(self, receiver: str, limit: int) -> list[Kept]:
        return self._store().after(self._cursor(receiver), limit)

    def _behind(self, receiver: str) -> int:
        return max(self._store().last_sequence() - self._cursor(receiver), 0)

    def _note(self, receiver: str, sequence: int) -> None:
        self._cursors[receiver] = sequence
        try:
            self._store().note_delivery(receiver, sequence)
        except sqlite3.Error as error:
            self._lose_disk(error)

    def _close(self) -> None:
        for store in (self._disk, self._memory):
            if store is not None:
                store.close()
