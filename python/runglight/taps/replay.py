"""Replay of a log: `replay:FILE?speed=10`, the double to test a set-up with.

Rows keep the log's own times; only their pace is the clock's. `speed=max` (or 0) does not wait.
"""

import asyncio
import math
from collections.abc import AsyncIterator

from runglight.errors import InputError
from runglight.log.changelog import Log, read_log_with
from runglight.log.options import ReadOptions
from runglight.taps.base import (
    QUIET_NS,
    Answer,
    Batch,
    Connection,
    ConnectionState,
    Tap,
    TapSignal,
)
from runglight.taps.clock import Clock
from runglight.taps.replay_cuts import ReplayCuts, signals_of
from runglight.taps.url import SourceUrl


class ReplayTap(Tap):
    """A log as if it were happening. Its signals are known once entered, or iterated."""

    def __init__(self, url: SourceUrl, clock: Clock) -> None:
        self.url = url.text
        self.signals: list[TapSignal] = []
        self.connection = Connection()
        self.interval_ns: int | None = None
        if not url.path:
            raise InputError(f"{url.text}: names no file; write replay:FILE?speed=10")
        self._path = url.path
        self._speed = _speed(url)
        self._clock = clock
        self._log: Log | None = None
        self._closed = asyncio.Event()

    async def __aenter__(self) -> "ReplayTap":
        await self._read()
        return self

    async def __aiter__(self) -> AsyncIterator[Batch]:
        """The rows, and after the last of them one empty batch."""
        log = await self._read()
        if not self._closed.is_set():
            self.connection = Connection(ConnectionState.CONNECTED)
        cuts = ReplayCuts(log)
        pace = _Pace(self._clock, self._speed, log.engine.start_ns or 0)
        told_ns = 0
        while (next_ns := cuts.next_ns) is not None:
            while (reached_ns := pace.reached_ns()) is not None and reached_ns < next_ns:
                quiet_ns = cuts.quiet_until_ns(reached_ns)
                if 0 < told_ns < quiet_ns:
                    told_ns = quiet_ns
                    yield Batch(until_ns=quiet_ns)
                await self._sleep_until(min(pace.due_ns(next_ns), self._clock.now_ns() + QUIET_NS))
                if self._closed.is_set():
                    return
            # Others run, however fast this goes.
            await asyncio.sleep(0)
            if self._closed.is_set():
                return
            batch = cuts.take(reached_ns)
            told_ns = batch.until_ns
            yield batch
        if not self._closed.is_set():
            yield cuts.last()

    async def check(self) -> list[Answer]:
        """Every signal of the log with its last value."""
        log = await self._read()
        _, indices, values = log.columns()
        last: dict[int, int] = dict(zip(indices.tolist(), values.tolist(), strict=True))
        return [
            Answer(signal, last.get(index), None if index in last else "the log has no row of it")
            for index, signal in enumerate(self.signals)
        ]

    async def close(self) -> None:
        """Ends an iteration under way."""
        self._closed.set()
        self.connection = Connection(ConnectionState.CLOSED)

    async def _read(self) -> Log:
        if self._log is None:
            # Large logs take a while, in which other taps go on.
            log = await asyncio.to_thread(read_log_with, self._path, ReadOptions())
            self.signals = signals_of(log)
            self.interval_ns = log.engine.scan_interval_ns
            self._log = log
        return self._log

    async def _sleep_until(self, time_ns: int) -> None:
        sleeping = asyncio.ensure_future(self._clock.sleep_until(time_ns))
        closing = asyncio.ensure_future(self._closed.wait())
        try:
            await asyncio.wait({sleeping, closing}, return_when=asyncio.FIRST_COMPLETED)
        finally:
            sleeping.cancel()
            closing.cancel()
            await asyncio.gather(sleeping, closing, return_exceptions=True)


class _Pace:
    """The log's time by the clock; None where nothing is waited for."""

    def __init__(self, clock: Clock, speed: float | None, first_ns: int) -> None:
        self._clock = clock
        self._speed = speed
        self._first_ns = first_ns
        self._started_ns = clock.now_ns()

    def reached_ns(self) -> int | None:
        """The log's time now."""
        if self._speed is None:
            return None
        return self._first_ns + int((self._clock.now_ns() - self._started_ns) * self._speed)

    def due_ns(self, log_ns: int) -> int:
        """The clock's time at which the log's time is reached."""
        assert self._speed is not None
        return self._started_ns + math.ceil((log_ns - self._first_ns) / self._speed)


def _speed(url: SourceUrl) -> float | None:
    text = url.options.get("speed", "1")
    if text == "max":
        return None
    try:
        speed = float(text)
    except ValueError:
        speed = -1.0
    if not 0 <= speed < math.inf:
        raise InputError(
            f"{url.text}: speed={text} is no speed; write 10 for ten times as fast, or max"
        )
    return speed or None
