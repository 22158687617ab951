"""The two places where a scanner runs, each with a scanner that a test makes up."""

import asyncio
import threading
from collections.abc import AsyncGenerator, Callable

import pytest

from runglight.errors import InputError
from runglight.taps import running
from runglight.taps.base import Batch
from runglight.taps.running import Batches, InLoop, OwnThread, Running

HANGS_S = 30

Start = Callable[[Batches], Running]
STARTS: list[Start] = [InLoop, lambda batches: OwnThread(batches, "test-scanner")]


def counting(seen: list[int] | None = None, pause_s: float = 0.0) -> Batches:
    async def batches() -> AsyncGenerator[Batch, None]:
        number = 0
        try:
            while True:
                number += 1
                if seen is not None:
                    seen.append(number)
                yield Batch(until_ns=number)
                await asyncio.sleep(pause_s)
        finally:
            if seen is not None:
                seen.append(-1)

    return batches


def run(test: Callable[[], object]) -> None:
    async def guarded() -> None:
        async with asyncio.timeout(HANGS_S):
            await test()  # type: ignore[misc]

    asyncio.run(guarded())


@pytest.fixture(params=STARTS, ids=["in loop", "own thread"])
def start(request: pytest.FixtureRequest) -> Start:
    started: Start = request.param
    return started


def test_batches_come_in_order_and_stopping_closes_the_scanner(start: Start) -> None:
    async def test() -> None:
        seen: list[int] = []
        scanner = start(counting(seen))
        came = [await scanner.next() for _ in range(5)]
        assert [batch.until_ns for batch in came if batch is not None] == [1, 2, 3, 4, 5]
        await scanner.stop()
        await scanner.stop()
        assert seen[-1] == -1
        assert not any(thread.name == "test-scanner" for thread in threading.enumerate())

    run(test)


def test_stopping_ends_a_wait(start: Start) -> None:
    async def test() -> None:
        scanner = start(counting(pause_s=3_600))
        assert await scanner.next() is not None
        waiting = asyncio.ensure_future(scanner.next())
        await asyncio.sleep(0.01)
        await scanner.stop()
        assert await waiting is None

    run(test)


def test_stopping_leaves_the_reader_uncancelled(start: Start) -> None:
    async def test() -> None:
        scanner = start(counting(pause_s=3_600))

        async def read() -> int:
            while await scanner.next() is not None:
                pass
            task = asyncio.current_task()
            assert task is not None
            await asyncio.sleep(0)
            return task.cancelling()

        reading = asyncio.ensure_future(read())
        await asyncio.sleep(0.01)
        await scanner.stop()
        assert await reading == 0

    run(test)


def test_a_reader_cancelled_while_stopping_stays_cancelled() -> None:
    async def test() -> None:
        scanner = InLoop(counting(pause_s=3_600))
        await scanner.next()
        reading = asyncio.ensure_future(scanner.next())
        await asyncio.sleep(0.01)
        reading.cancel()
        await scanner.stop()
        await asyncio.wait([reading])
        assert reading.cancelled()

    run(test)


def test_a_reader_that_is_cancelled_stays_so(start: Start) -> None:
    async def test() -> None:
        scanner = start(counting(pause_s=3_600))
        assert await scanner.next() is not None
        waiting = asyncio.ensure_future(scanner.next())
        await asyncio.sleep(0.01)
        waiting.cancel()
        await asyncio.wait([waiting])
        assert waiting.cancelled()
        await scanner.stop()

    run(test)


def test_errors_reach_the_reader_after_the_batches_before_them(start: Start) -> None:
    async def batches() -> AsyncGenerator[Batch, None]:
        yield Batch(until_ns=1)
        raise InputError("the device has no coils")

    async def test() -> None:
        scanner = start(batches)
        assert await scanner.next() is not None
        with pytest.raises(InputError, match="no coils"):
            await scanner.next()
        await scanner.stop()

    run(test)


def test_in_loop_nothing_is_scanned_that_nobody_asked_for() -> None:
    async def test() -> None:
        seen: list[int] = []
        scanner = InLoop(counting(seen))
        await scanner.next()
        await asyncio.sleep(0.01)
        assert seen == [1]
        await scanner.stop()

    run(test)


def test_a_reader_far_behind_stops_the_scanning(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(running, "MOST_WAITING", 10)

    async def test() -> None:
        seen: list[int] = []
        scanner = OwnThread(counting(seen), "test-scanner")
        await scanner.next()
        while len(seen) < 11:
            await asyncio.sleep(0.001)
        await asyncio.sleep(0.05)
        # What waits, the batch in the reader's hand, and the one that finds no room.
        assert len(seen) <= 12
        # Nothing of it is lost.
        for number in range(2, 30):
            batch = await scanner.next()
            assert batch is not None
            assert batch.until_ns == number
        await scanner.stop()

    run(test)
