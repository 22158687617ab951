"""Where a scanner runs: in the reader's own event loop, or in a thread with one of its own."""

import asyncio
import threading
from collections import deque
from collections.abc import AsyncGenerator, Callable
from contextlib import aclosing, suppress
from typing import Any, Protocol

from runglight.taps.base import Batch

MOST_WAITING = 10_000
"""Batches; a reader that far behind stops the scanning, which shows as a gap."""
LOOK_AGAIN_S = 0.001

Batches = Callable[[], AsyncGenerator[Batch, None]]


class Running(Protocol):
    """Batches on their way to one reader."""

    async def next(self) -> Batch | None:
        """The next batch; None where it was stopped."""

    async def stop(self) -> None:
        """Ends `next`, and the scanner. May be called twice."""


class InLoop:
    """Scans only when asked for the next batch: a simulated machine's time waits for its reader.

    It scans in the reader's own task, so that a clock which stands still while somebody works
    stands still for whoever works on a batch.
    """

    def __init__(self, batches: Batches) -> None:
        self._batches = batches()
        self._reader: asyncio.Task[Any] | None = None
        self._left = asyncio.Event()
        self._stopped = False

    async def next(self) -> Batch | None:
        """The next batch; None where it was stopped."""
        if self._stopped:
            return None
        reader = asyncio.current_task()
        assert reader is not None
        before = reader.cancelling()
        self._reader = reader
        self._left.clear()
        try:
            batch = await anext(self._batches)
        except asyncio.CancelledError:
            if not self._took_back_stop(reader, before):
                raise
            return None
        finally:
            self._reader = None
            self._left.set()
        return None if self._took_back_stop(reader, before) else batch

    async def stop(self) -> None:
        """Ends `next`, and the scanner."""
        if self._stopped:
            return
        self._stopped = True
        if self._reader is not None:
            self._reader.cancel()
            await self._left.wait()
        await self._batches.aclose()

    def _took_back_stop(self, reader: "asyncio.Task[Any]", before: int) -> bool:
        """Whether only `stop` cancelled the reader; that is no matter of the reader's task."""
        return self._stopped and reader.cancelling() > before and reader.uncancel() <= before


class OwnThread:
    """Scans in its own thread, so that neither the reader's work nor its waits stretch a scan."""

    def __init__(self, batches: Batches, name: str) -> None:
        self._batches = batches
        self._ready: deque[Batch | BaseException | None] = deque()
        self._reader = asyncio.get_running_loop()
        self._came = asyncio.Event()
        self._stopped = False
        self._scanning: tuple[asyncio.AbstractEventLoop, asyncio.Task[None]] | None = None
        self._started = threading.Event()
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)
        self._thread.start()

    async def next(self) -> Batch | None:
        """The next batch; None where it was stopped."""
        while not self._ready:
            self._came.clear()
            await self._came.wait()
        item = self._ready.popleft()
        if isinstance(item, BaseException):
            raise item
        return None if self._stopped else item

    async def stop(self) -> None:
        """Ends `next`, and the scanner."""
        self._stopped = True
        await asyncio.to_thread(self._started.wait)
        if self._scanning is not None:
            loop, task = self._scanning
            with suppress(RuntimeError):  # its loop has ended by itself
                loop.call_soon_threadsafe(task.cancel)
        await asyncio.to_thread(self._thread.join)

    def _run(self) -> None:
        try:
            asyncio.run(self._scan())
        except asyncio.CancelledError:
            pass
        except BaseException as error:  # raised again where the reader waits
            self._give(error)
        finally:
            self._started.set()
            self._give(None)

    async def _scan(self) -> None:
        task = asyncio.current_task()
        assert task is not None
        self._scanning = (asyncio.get_running_loop(), task)
        self._started.set()
        async with aclosing(self._batches()) as batches:
            async for batch in batches:
                while len(self._ready) >= MOST_WAITING:
                    await asyncio.sleep(LOOK_AGAIN_S)
                self._give(batch)

    def _give(self, item: Batch | BaseException | None) -> None:
        self._ready.append(item)
        with suppress(RuntimeError):  # the reader's loop is closed: nobody waits any more
            self._reader.call_soon_threadsafe(self._came.set)
