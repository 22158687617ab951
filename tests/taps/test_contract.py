"""What every tap promises (`runglight.taps.base`), against a real server of its protocol."""

import asyncio
import itertools
import time
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager

import numpy as np
import pytest

from runglight.errors import InputError
from runglight.taps import open_tap
from runglight.taps.base import Batch, ConnectionState, Gap, Tap
from tests.taps.benches import BENCHES
from tests.taps.benches.bench import Bench

HANGS_S = 60

Body = Callable[[Bench], Awaitable[None]]


@pytest.fixture(params=BENCHES, ids=lambda bench: bench.__name__)
def on_bench(request: pytest.FixtureRequest) -> Callable[[Body], None]:
    """Runs a test's body on a started bench, which is stopped whatever happens."""

    async def run(body: Body) -> None:
        bench: Bench = request.param()
        await bench.start()
        try:
            async with asyncio.timeout(HANGS_S):
                await body(bench)
        finally:
            await bench.kill()

    return lambda body: asyncio.run(run(body))


@pytest.fixture
def on_live_bench(
    request: pytest.FixtureRequest, on_bench: Callable[[Body], None]
) -> Callable[[Body], None]:
    """The same, for what needs a server that can be changed and killed."""
    if not request.node.callspec.params["on_bench"].live:
        pytest.skip("a log is neither changed nor killed")
    return on_bench


@asynccontextmanager
async def tapped(url: str) -> AsyncIterator[tuple[Tap, AsyncIterator[Batch]]]:
    # A busy computer is no lost connection.
    patience = "&timeout=5s" if url.startswith(("modbus:", "s7:")) else ""
    async with open_tap(url + patience, interval="5ms") as tap:
        yield tap, aiter(tap)


async def rows_until(batches: AsyncIterator[Batch], enough: Callable[[Batch], bool]) -> list[Batch]:
    seen: list[Batch] = []
    async for batch in batches:
        seen.append(batch)
        if enough(batch):
            return seen
    raise AssertionError("the iteration ended early")


def has_gap(batch: Batch) -> bool:
    return any(isinstance(mark, Gap) for mark in batch.marks)


def test_the_first_rows_are_all_signals_as_they_stand(on_bench: Callable[[Body], None]) -> None:
    async def body(bench: Bench) -> None:
        async with tapped(bench.url) as (tap, batches):
            first = await anext(batches)
            assert first.image
            assert not first.marks
            assert [tap.signals[index].name for index in first.signal_index] == list(bench.signals)
            assert len(first.time_ns) == len(first.value) == len(bench.signals)
            assert tap.connection.state is ConnectionState.CONNECTED

    on_bench(body)


def test_columns_have_the_types_of_the_seam(on_bench: Callable[[Body], None]) -> None:
    async def body(bench: Bench) -> None:
        async with tapped(bench.url) as (_, batches):
            first = await anext(batches)
            assert first.time_ns.dtype == first.value.dtype == first.scan_ns.dtype == np.int64
            assert first.signal_index.dtype == np.uint32

    on_bench(body)


def test_a_change_is_seen_between_its_writing_and_its_reading(
    on_live_bench: Callable[[Body], None],
) -> None:
    async def body(bench: Bench) -> None:
        async with tapped(bench.url) as (tap, batches):
            index = bench.signals.index(bench.changing)
            await anext(batches)
            for value in (1, 0, 1):
                before_ns = time.time_ns()
                await bench.change(value)
                seen = (await rows_until(batches, lambda batch: len(batch) > 0))[-1]
                after_ns = time.time_ns()
                # A computer too busy to look often says so, and how all signals stand.
                assert seen.image is has_gap(seen)
                told = dict(zip(seen.signal_index.tolist(), seen.value.tolist(), strict=True))
                assert told[index] == value
                assert seen.image or len(told) == 1
                # The steady clock may stand off the computer's by what it follows gently.
                off_ns = 50_000_000
                assert before_ns - off_ns <= seen.time_ns[0] <= after_ns + off_ns
            assert tap.signals[index].name == bench.changing

    on_live_bench(body)


def test_time_never_runs_backwards_and_goes_on_without_changes(
    on_bench: Callable[[Body], None],
) -> None:
    async def body(bench: Bench) -> None:
        async with tapped(bench.url) as (_, batches):
            seen = [await anext(batches) for _ in range(5)]
            assert any(len(batch) == 0 for batch in seen)
            untils = [batch.until_ns for batch in seen]
            assert untils == sorted(set(untils))
            times = np.concatenate([batch.time_ns for batch in seen])
            scans = np.concatenate([batch.scan_ns for batch in seen])
            assert (np.diff(times) >= 0).all()
            assert (np.diff(scans) > 0).all()
            assert (len(scans) > 0) is bench.polls
            for earlier, later in itertools.pairwise(seen):
                assert (later.time_ns > earlier.until_ns).all()
            for batch in seen:
                assert (batch.time_ns <= batch.until_ns).all()

    on_bench(body)


def test_inputs_come_before_outputs_and_outputs_before_memory(
    on_live_bench: Callable[[Body], None],
) -> None:
    async def body(bench: Bench) -> None:
        async with tapped(bench.url) as (tap, batches):
            first = await anext(batches)
            order = {"input": 0, "output": 1, "memory": 2}
            classes = [order[tap.signals[index].signal_class] for index in first.signal_index]
            assert classes == sorted(classes)
            # What sends by itself does not tell inputs from outputs.
            assert set(classes) == ({0, 1, 2} if bench.polls else {2})

    on_live_bench(body)


def test_a_killed_server_is_a_gap_and_then_a_whole_image(
    on_live_bench: Callable[[Body], None],
) -> None:
    async def body(bench: Bench) -> None:
        async with tapped(bench.url) as (tap, batches):
            await anext(batches)
            await bench.change(1)
            before = await rows_until(batches, lambda batch: len(batch) > 0)
            names = [signal.name for signal in tap.signals]
            for restart in (1, 2):
                reading = asyncio.ensure_future(rows_until(batches, has_gap))
                await bench.kill()
                while tap.connection.state is not ConnectionState.RETRYING:
                    await asyncio.sleep(0.01)
                assert tap.connection.reason
                await bench.start()
                after = await reading
                back = after[-1]
                (gap,) = back.marks
                assert isinstance(gap, Gap)
                assert gap.start_ns < gap.end_ns <= back.time_ns[0]
                last = [*before, *after[:-1]][-1]
                if bench.polls:
                    assert gap.start_ns == last.until_ns
                else:
                    # Heartbeats went on until the silence was noticed; the last word is older.
                    assert (last.time_ns <= gap.start_ns).all()
                assert gap.reason
                assert back.image
                assert len(back) == len(bench.signals)
                # A server starts anew with zeros, and no image but the one after the gap tells it.
                assert back.value[bench.signals.index(bench.changing)] == 0
                assert not any(len(batch) for batch in after[:-1])
                assert tap.connection.state is ConnectionState.CONNECTED
                assert tap.connection.reconnects == restart
                assert [signal.name for signal in tap.signals] == names
                before = [back]

    on_live_bench(body)


def test_a_server_that_is_not_there_yet_is_waited_for(
    on_live_bench: Callable[[Body], None],
) -> None:
    async def body(bench: Bench) -> None:
        await bench.kill()
        async with tapped(bench.url) as (tap, batches):
            reading = asyncio.ensure_future(anext(batches))
            while tap.connection.state is not ConnectionState.RETRYING:
                await asyncio.sleep(0.01)
            await bench.start()
            first = await reading
            assert first.image
            assert not first.marks
            assert tap.connection.reconnects == 0

    on_live_bench(body)


def test_closing_ends_an_iteration_under_way(on_bench: Callable[[Body], None]) -> None:
    async def body(bench: Bench) -> None:
        tap = open_tap(bench.url, interval="5ms")
        async with tap:
            batches = aiter(tap)
            await anext(batches)

            async def rest() -> list[Batch]:
                return [batch async for batch in batches]

            reading = asyncio.ensure_future(rest())
            await asyncio.sleep(0)
            await tap.close()
            await tap.close()
            await reading
        assert tap.connection.state is ConnectionState.CLOSED

    on_bench(body)


def test_scanning_without_pause_can_be_closed(on_bench: Callable[[Body], None]) -> None:
    async def body(bench: Bench) -> None:
        if not bench.polls:
            pytest.skip("only what is polled is scanned without pause")
        for _ in range(20):
            async with open_tap(bench.url, interval="0") as tap:
                await anext(aiter(tap))

    on_bench(body)


def test_a_reader_that_is_cancelled_leaves_nothing_running(
    on_bench: Callable[[Body], None],
) -> None:
    async def body(bench: Bench) -> None:
        async def read() -> None:
            async with open_tap(bench.url) as tap:
                async for _ in tap:
                    started.set()
                await asyncio.Event().wait()

        started = asyncio.Event()
        reading = asyncio.ensure_future(read())
        await started.wait()
        reading.cancel()
        with pytest.raises(asyncio.CancelledError):
            await reading

    on_bench(body)


def test_check_reads_every_signal_once(on_bench: Callable[[Body], None]) -> None:
    async def body(bench: Bench) -> None:
        if bench.live:
            await bench.change(1)
        answers = await open_tap(bench.url).check()
        assert [answer.signal.name for answer in answers] == list(bench.signals)
        assert all(answer.error is None and answer.value is not None for answer in answers)
        if bench.live:
            assert answers[bench.signals.index(bench.changing)].value == 1

    on_bench(body)


def test_check_names_what_does_not_answer(on_live_bench: Callable[[Body], None]) -> None:
    async def body(bench: Bench) -> None:
        if bench.name_of_missing is None:
            pytest.skip("this protocol knows no missing addresses")
        answers = {
            answer.signal.name: answer for answer in await open_tap(bench.missing_url).check()
        }
        missing = answers[bench.name_of_missing]
        assert missing.value is None
        assert missing.error
        assert any(answer.error is None for answer in answers.values())

    on_live_bench(body)


def test_what_is_not_there_is_refused_in_one_sentence(on_bench: Callable[[Body], None]) -> None:
    async def body(bench: Bench) -> None:
        with pytest.raises(InputError) as refused:
            async with tapped(bench.missing_url) as (_, batches):
                await anext(batches)
        assert "\n" not in str(refused.value)
        assert bench.missing_url.partition(":")[2].strip("/").partition("?")[0] in str(
            refused.value
        )

    on_bench(body)


def test_check_of_a_host_that_never_answers_is_an_input_error(
    on_live_bench: Callable[[Body], None],
) -> None:
    async def body(bench: Bench) -> None:
        assert bench.unreachable_url is not None
        with pytest.raises(InputError, match=r"127\.0\.0\.1"):
            await open_tap(bench.unreachable_url).check()

    on_live_bench(body)


def test_an_unknown_option_is_refused_in_one_sentence(on_bench: Callable[[Body], None]) -> None:
    async def body(bench: Bench) -> None:
        joint = "&" if "?" in bench.url else "?"
        with pytest.raises(InputError, match="unknown option 'colour'") as refused:
            open_tap(f"{bench.url}{joint}colour=blue")
        assert "\n" not in str(refused.value)

    on_bench(body)
