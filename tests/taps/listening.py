"""Reads a tap until something is seen; every wait ends after `HANG_S`, which only a hang needs."""

import asyncio
from collections.abc import Callable
from types import TracebackType
from typing import Self

from runglight.taps.base import Batch, Gap, Tap

HANG_S = 30.0


class Listener:
    """Keeps all batches of a tap, read in the background, as the contract says they come."""

    def __init__(self, tap: Tap) -> None:
        self.tap = tap
        self.batches: list[Batch] = []
        self._came = asyncio.Condition()

    async def __aenter__(self) -> Self:
        await self.tap.__aenter__()
        self.reading = asyncio.create_task(self._read())
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        await self.tap.__aexit__(kind, error, trace)
        async with asyncio.timeout(HANG_S):
            await asyncio.wait([self.reading])
        if error is None:
            self.reading.result()
        else:
            self.reading.cancelled() or self.reading.exception()

    async def _read(self) -> None:
        try:
            async for batch in self.tap:
                async with self._came:
                    self.batches.append(batch)
                    self._came.notify_all()
        finally:
            async with self._came:
                self._came.notify_all()

    async def until(self, seen: Callable[[], object]) -> None:
        """Waits for `seen()` to be true."""
        async with asyncio.timeout(HANG_S), self._came:
            while not seen():
                if self.reading.done():
                    self.reading.result()
                    raise AssertionError("the iteration ended")
                await self._came.wait()

    @property
    def images(self) -> list[dict[str, int]]:
        """The images so far, by name."""
        return [dict(self.named(batch)) for batch in self.batches if batch.image]

    @property
    def gaps(self) -> list[Gap]:
        """The gaps so far."""
        return [mark for batch in self.batches for mark in batch.marks if isinstance(mark, Gap)]

    def named(self, batch: Batch) -> list[tuple[str, int]]:
        """Rows of a batch: name and value."""
        return [
            (self.tap.signals[index].name, value)
            for index, value in zip(batch.signal_index.tolist(), batch.value.tolist(), strict=True)
        ]

    def changes(self, name: str) -> list[int]:
        """The values of one signal, images left out."""
        return [
            value
            for batch in self.batches
            if not batch.image
            for row, value in self.named(batch)
            if row == name
        ]

    def times(self, name: str) -> list[int]:
        """The times of the rows of one signal, images left out."""
        return [
            time
            for batch in self.batches
            if not batch.image
            for (row, _), time in zip(self.named(batch), batch.time_ns.tolist(), strict=True)
            if row == name
        ]


def check_order(batches: list[Batch]) -> None:
    """The promises about time that every tap gives."""
    assert batches
    assert batches[0].image or not len(batches[0])
    edge = 0
    row = 0
    for batch in batches:
        assert batch.until_ns > edge or (batch.image and batch.until_ns >= edge)
        assert len(batch.time_ns) == len(batch.signal_index) == len(batch.value)
        for time in batch.time_ns.tolist():
            assert row <= time
            assert edge < time <= batch.until_ns
            row = time
        edge = batch.until_ns
        for mark in batch.marks:
            if isinstance(mark, Gap):
                assert batch.image
                assert mark.start_ns <= mark.end_ns <= batch.until_ns
