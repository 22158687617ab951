"""A tap that a test drives by hand."""

import asyncio
from collections.abc import AsyncIterator, Sequence

import numpy as np

from runglight.log.changelog import Log
from runglight.taps.base import (
    Answer,
    Batch,
    Connection,
    ConnectionState,
    Mark,
    Tap,
    TapSignal,
)


class DoubleTap(Tap):
    """Gives the batches it is fed, in order, and ends when it is closed or told to."""

    def __init__(self, signals: Sequence[str]) -> None:
        self.url = "double://tap"
        self.signals = [TapSignal(name, name) for name in signals]
        self.connection = Connection(ConnectionState.CONNECTED)
        self.interval_ns = 10_000_000
        self._batches: asyncio.Queue[Batch | Exception | None] = asyncio.Queue()

    def feed(self, *batches: Batch) -> None:
        """Batches to give next."""
        for batch in batches:
            self._batches.put_nowait(batch)

    def end(self, error: Exception | None = None) -> None:
        """Ends the iteration after what was fed, or raises there."""
        self._batches.put_nowait(error)

    async def __aiter__(self) -> AsyncIterator[Batch]:
        while isinstance(batch := await self._batches.get(), Batch):
            yield batch
        if batch is not None:
            raise batch

    async def check(self) -> list[Answer]:
        return [Answer(signal, 0) for signal in self.signals]

    async def close(self) -> None:
        self.end()


def batch_of(
    log: Log, start: int, end: int, *, until_ns: int | None = None, marks: tuple[Mark, ...] = ()
) -> Batch:
    """Rows of a log as one batch; `until_ns` is the last row's time where not given."""
    time_ns, signal_index, value = (column[start:end] for column in log.columns())
    return Batch(
        until_ns=int(time_ns[-1]) if until_ns is None else until_ns,
        time_ns=np.ascontiguousarray(time_ns),
        signal_index=np.ascontiguousarray(signal_index),
        value=np.ascontiguousarray(value),
        scan_ns=np.unique(time_ns),
        marks=marks,
    )


def image_of(log: Log, row: int, *, at_ns: int, marks: tuple[Mark, ...] = ()) -> Batch:
    """All signals as they stand after a row of a log, as a tap reads them at its start."""
    _, signal_index, value = (column[:row] for column in log.columns())
    values = np.zeros(len(log.signals), np.int64)
    values[signal_index] = value
    return Batch(
        until_ns=at_ns,
        time_ns=np.full(len(values), at_ns, np.int64),
        signal_index=np.arange(len(values), dtype=np.uint32),
        value=values,
        scan_ns=np.array([at_ns], np.int64),
        marks=marks,
        image=True,
    )
