"""One live session: a tap in; findings told, kept, published and counted."""

from __future__ import annotations

import asyncio
import time
from datetime import datetime
from typing import TYPE_CHECKING, Protocol

from runglight.errors import InputError
from runglight.live.delivery import Delivery
from runglight.live.status import Progress, Status
from runglight.taps.base import ConnectionState

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from runglight.live.checkpoint import Checkpoint
    from runglight.live.delivery import Receiver
    from runglight.live.keeper import Keeper
    from runglight.live.metrics import Metrics
    from runglight.taps.base import Batch, Connection, Tap

TICK_S = 0.25
CLOSING_S = 3.0
"""How long the end may take to deliver what is left."""
BATCHES_IN_A_ROW = 32
"""After so many, others get their turn even where the tap never waits."""


class Recording(Protocol):
    """What takes every batch: `runglight.recording.Recorder`."""

    def append(self, batch: Batch) -> None:
        """Takes a batch and returns at once; InputError where it can take no more."""

    def close(self) -> None:
        """Writes the rest; may take a while, and raises as `append` does."""


class Watcher(Protocol):
    """What judges every batch: `BatchWatcher`."""

    late_rows: int

    def take(self, batch: Batch) -> list[str]:
        """The findings of one batch, as JSON lines."""

    def complete(self) -> list[str]:
        """No batch will come for a while, or ever."""

    def take_snapshots(self) -> list[str]:
        """Snapshots made since the last call, as JSON."""

    def state(self) -> bytes:
        """What a restart goes on from."""


class Session:
    """Watches until the tap ends or `stop` is called.

    `tell` is given the JSON lines of findings and must return at once; `say` is given sentences
    for the user, also from other threads; `show` is given the status four times a second.
    """

    def __init__(
        self,
        tap: Tap,
        watcher: Watcher,
        keeper: Keeper,
        *,
        tell: Callable[[list[str]], None],
        say: Callable[[str], None],
        show: Callable[[Status], None] | None = None,
        recording: Recording | None = None,
        checkpoint: Checkpoint | None = None,
        checkpoint_every_s: float = 10.0,
        metrics: Metrics | None = None,
        replayed: bool = False,
    ) -> None:
        self._tap = tap
        self._watcher = watcher
        self._keeper = keeper
        self._tell = tell
        self._say = say
        self._show = show
        self._recording = recording
        self._checkpoint = checkpoint
        self._checkpoint_every_s = checkpoint_every_s
        self._metrics = metrics
        self._replayed = replayed
        self._progress = Progress(tap.url)
        self._deliveries: list[Delivery] = []
        self._stopping = asyncio.Event()
        self._seen = tap.connection
        self._late_rows = 0
        self._recording_stopped = False

    def status(self) -> Status:
        """How watching goes."""
        return self._progress.status(self._tap.connection)

    def stop(self) -> None:
        """Ends the session soon, with everything kept."""
        self._stopping.set()

    async def run(
        self, receivers: Sequence[Receiver] = (), *, duration_s: float | None = None
    ) -> None:
        """Watches; raises what the tap raises (InputError where it can never work)."""
        self._deliveries = [Delivery(each, self._keeper, self._say) for each in receivers]
        await self._keeper.open(receivers)
        beside = [asyncio.create_task(self._keeper.run()), asyncio.create_task(self._tick())]
        delivering = [asyncio.create_task(each.run()) for each in self._deliveries]
        connected = [asyncio.create_task(each.run()) for each in receivers]
        pump = asyncio.create_task(self._pump())
        stopping = asyncio.create_task(self._stopping.wait())
        try:
            await asyncio.wait(
                {pump, stopping, *beside},
                timeout=duration_s,
                return_when=asyncio.FIRST_COMPLETED,
            )
        finally:
            stopping.cancel()
            await self._end_pump(pump)
            await _cancelled([*beside, *delivering])
            await self._finish()
            await _cancelled(connected)
            for receiver in receivers:
                await receiver.close()
            await self._keeper.close()
        for task in (pump, *beside):
            if not task.cancelled() and (error := task.exception()) is not None:
                raise error

    def take(self, batch: Batch) -> None:
        """Watches one batch."""
        self._look_at_connection(self._tap.connection)
        started_s = time.perf_counter()
        lines = self._watcher.take(batch)
        took_s = time.perf_counter() - started_s
        self._hand_on(lines)
        self._record(batch)
        self._progress.batch(batch)
        if self._metrics is not None:
            self._metrics.batch(self._progress, took_s)

    def _record(self, batch: Batch) -> None:
        if self._recording is None or self._recording_stopped:
            return
        try:
            self._recording.append(batch)
        except InputError as error:
            # A full disk is no reason to leave the machine unwatched.
            self._recording_stopped = True
            self._say(f"{error}; watching goes on")

    async def _pump(self) -> None:
        in_a_row = 0
        async for batch in self._tap:
            self.take(batch)
            in_a_row += 1
            if in_a_row % BATCHES_IN_A_ROW == 0:
                await asyncio.sleep(0)

    def _hand_on(self, lines: list[str]) -> None:
        snapshots = self._watcher.take_snapshots()
        if not lines:
            return
        self._tell(lines)
        self._keeper.put(lines, snapshots)
        new = self._progress.findings(lines)
        if self._metrics is not None:
            self._metrics.findings(new, self._progress.open_findings)
            if new and not self._replayed:
                happened_s = datetime.fromisoformat(new[0].time).timestamp()
                self._metrics.told(time.time() - happened_s)

    async def _tick(self) -> None:
        next_checkpoint_s = time.monotonic() + self._checkpoint_every_s
        while True:
            await asyncio.sleep(TICK_S)
            self._look_at_connection(self._tap.connection)
            if self._watcher.late_rows != self._late_rows:
                self._late_rows = self._watcher.late_rows
                self._say(
                    f"{self._tap.url}: {self._late_rows:,} changes came after the tap had said "
                    "that their time was over; they are taken as if they had just happened"
                )
            if self._metrics is not None:
                self._metrics.connection(self._tap.connection)
                self._metrics.deliveries(self._deliveries, self._keeper.dropped)
            if self._show is not None:
                self._show(self.status())
            if self._checkpoint is not None and time.monotonic() >= next_checkpoint_s:
                await self._save()
                next_checkpoint_s = time.monotonic() + self._checkpoint_every_s

    def _look_at_connection(self, now: Connection) -> None:
        before, self._seen = self._seen, now
        if now is before:
            return
        if now.state is ConnectionState.RETRYING and before.state is not now.state:
            self._say(f"{self._tap.url}: connection lost: {now.reason}; trying again")
            # A gap follows: nothing more can come of the scan that waits for its end.
            self._hand_on(self._watcher.complete())
        elif now.state is ConnectionState.CONNECTED and (
            # It may have been away for less than a look.
            before.state is ConnectionState.RETRYING or now.reconnects > before.reconnects
        ):
            self._say(f"{self._tap.url}: connected again")

    async def _save(self) -> None:
        if self._checkpoint is None:
            return
        state = self._watcher.state()
        # Whatever the state has told already must be on disk before it.
        await self._keeper.flush()
        try:
            await asyncio.to_thread(self._checkpoint.save, state)
        except OSError as error:
            self._say(f"{self._checkpoint.path}: the state cannot be kept: {error.strerror}")

    async def _end_pump(self, pump: asyncio.Task[None]) -> None:
        await self._tap.close()
        await asyncio.wait({pump}, timeout=CLOSING_S)
        await _cancelled([pump])

    async def _end_recording(self) -> None:
        if self._recording is None:
            return
        try:
            await asyncio.to_thread(self._recording.close)
        except InputError as error:
            if not self._recording_stopped:
                self._say(str(error))

    async def _finish(self) -> None:
        # What is replayed goes on where it ended, and its last scan with it.
        if not (self._replayed and self._checkpoint is not None):
            self._hand_on(self._watcher.complete())
        await self._save()
        await self._keeper.flush()
        await self._end_recording()
        await asyncio.gather(*(each.finish(CLOSING_S) for each in self._deliveries))
        if self._metrics is not None:
            self._metrics.deliveries(self._deliveries, self._keeper.dropped)
        if self._keeper.dropped:
            self._say(f"{self._keeper.dropped:,} findings are lost: no disk took them for too long")


async def _cancelled(tasks: Sequence[asyncio.Task[None]]) -> None:
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)
