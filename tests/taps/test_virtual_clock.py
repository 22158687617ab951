"""Virtual time: who wakes when, who makes it stand still, and how it turns into real time."""

import asyncio
import time
from collections.abc import AsyncIterator, Coroutine
from contextlib import suppress
from typing import TypeVar

import pytest

from runglight.taps.virtual_clock import VirtualClock

T = TypeVar("T")
S = 1_000_000_000
START_NS = 1_767_592_800 * S


def run(work: Coroutine[object, object, T]) -> T:
    """Runs it to its end; a guard against hanging, never a measure."""
    return asyncio.run(asyncio.wait_for(work, 300))


def test_hours_pass_at_once() -> None:
    async def work() -> int:
        clock = VirtualClock(START_NS)
        for hour in range(1, 101):
            await clock.sleep_until(START_NS + hour * 3600 * S)
            assert clock.now_ns() == START_NS + hour * 3600 * S
        return clock.now_ns()

    began_s = time.monotonic()
    assert run(work()) == START_NS + 360_000 * S
    assert time.monotonic() - began_s < 60
    assert VirtualClock(START_NS).take_step_ns() is None


def test_several_sleepers_wake_in_the_order_of_their_moments() -> None:
    async def work() -> list[tuple[str, int]]:
        clock, woken = VirtualClock(0), []

        async def every(name: str, step_ns: int, times: int) -> None:
            for number in range(1, times + 1):
                await clock.sleep_until(number * step_ns)
                woken.append((name, clock.now_ns()))

        await asyncio.gather(every("a", 10, 30), every("b", 7, 30), every("c", 25, 12))
        return woken

    woken = run(work())
    assert len(woken) == 72
    assert [moment for _, moment in woken] == sorted(moment for _, moment in woken)
    for name, step_ns in (("a", 10), ("b", 7), ("c", 25)):
        moments = [moment for other, moment in woken if other == name]
        assert moments == [step_ns * number for number in range(1, len(moments) + 1)]


def test_those_of_one_moment_wake_in_the_order_in_which_they_fell_asleep() -> None:
    async def work() -> list[int]:
        clock, woken = VirtualClock(0), []

        async def sleep(number: int) -> None:
            await clock.sleep_until(100)
            woken.append(number)

        await asyncio.gather(*(sleep(number) for number in range(20)))
        return woken

    assert run(work()) == list(range(20))


def test_a_moment_that_has_passed_only_lets_others_run() -> None:
    async def work() -> None:
        clock, ran = VirtualClock(100), []
        asyncio.get_running_loop().call_soon(ran.append, True)
        await clock.sleep_until(100)
        await clock.sleep_until(3)
        assert ran == [True]
        assert clock.now_ns() == 100

    run(work())


def test_time_stands_still_while_somebody_who_takes_part_works() -> None:
    async def work() -> None:
        clock = VirtualClock(0)
        seen: list[tuple[int, int]] = []

        async def echo(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            while data := await reader.read(1):
                writer.write(data)
            writer.close()

        server = await asyncio.start_server(echo, "127.0.0.1", 0)
        reader, writer = await asyncio.open_connection(*server.sockets[0].getsockname())

        async def poll() -> None:
            for number in range(1, 101):
                await clock.sleep_until(number * 1000)
                before_ns = clock.now_ns()
                for _ in range(3):
                    writer.write(b"x")
                    assert await reader.read(1) == b"x"
                    await asyncio.to_thread(int)
                seen.append((before_ns, clock.now_ns()))
            writer.close()
            await writer.wait_closed()

        async def rare() -> None:
            for number in range(1, 11):
                await clock.sleep_until(number * 10_000)

        await asyncio.gather(poll(), rare())
        server.close()
        await server.wait_closed()
        assert seen == [(number * 1000, number * 1000) for number in range(1, 101)]

    run(work())


def test_an_iterator_awaited_in_a_new_task_each_time_is_waited_for_too() -> None:
    """As watchers do: `asyncio.wait_for(anext(tap), …)`, beside a timer of their own."""

    async def work() -> None:
        clock = VirtualClock(0)

        async def scans() -> AsyncIterator[int]:
            await clock.sleep_until(0)  # from here on it takes part
            await asyncio.to_thread(time.sleep, 0.02)  # it connects
            for number in range(1, 201):
                await clock.sleep_until(number * 1000)
                await asyncio.to_thread(int)
                yield clock.now_ns()

        async def rare() -> None:
            while True:
                await clock.sleep_until(clock.now_ns() + 3_300)

        timer = asyncio.create_task(rare())
        tap, seen = scans(), []
        with suppress(StopAsyncIteration):
            while True:
                seen.append(await asyncio.wait_for(anext(tap), 120))
        timer.cancel()
        assert seen == [number * 1000 for number in range(1, 201)]

    run(work())


def test_hold_stops_time_for_work_that_has_never_slept() -> None:
    async def work() -> None:
        clock = VirtualClock(0)
        sleeper = asyncio.create_task(clock.sleep_until(1000))
        with clock.hold():
            await asyncio.sleep(0.05)
            assert clock.now_ns() == 0
        await sleeper
        assert clock.now_ns() == 1000

    run(work())


def test_waiting_for_what_only_time_can_bring_does_not_stop_it_for_ever() -> None:
    async def work() -> None:
        clock, bell = VirtualClock(0, patience_s=0.05), asyncio.Event()

        async def ring() -> None:
            await clock.sleep_until(1000)
            bell.set()

        async def listen() -> int:
            await clock.sleep_until(1)
            await bell.wait()
            return clock.now_ns()

        heard, _ = await asyncio.gather(listen(), ring())
        assert heard == 1000

    run(work())


def test_a_sleeper_that_is_cancelled_holds_nobody_up() -> None:
    async def work() -> None:
        clock = VirtualClock(0)
        short = asyncio.create_task(clock.sleep_until(10))
        long = asyncio.create_task(clock.sleep_until(1000))
        await asyncio.sleep(0)
        short.cancel()
        with pytest.raises(asyncio.CancelledError):
            await short
        await long
        assert clock.now_ns() == 1000

    run(work())


def test_who_listens_hears_every_jump() -> None:
    async def work() -> list[int]:
        clock, heard = VirtualClock(0), []
        clock.on_advance(heard.append)
        await asyncio.gather(clock.sleep_until(5), clock.sleep_until(9), clock.sleep_until(5))
        clock.advance_to(20)
        return heard

    assert run(work()) == [5, 9, 20]


def test_what_a_listener_raises_reaches_the_sleeper() -> None:
    async def work() -> None:
        clock = VirtualClock(0)

        def fail(_: int) -> None:
            raise ValueError("the plant is broken")

        clock.on_advance(fail)
        with pytest.raises(ValueError, match="the plant is broken"):
            await clock.sleep_until(5)

    run(work())


def test_advancing_past_sleepers_wakes_them_and_never_goes_back() -> None:
    async def work() -> None:
        clock = VirtualClock(0)
        sleepers = [asyncio.create_task(clock.sleep_until(moment)) for moment in (10, 20, 30)]
        await asyncio.sleep(0)
        clock.advance_to(25)
        await asyncio.gather(*sleepers[:2])
        assert clock.now_ns() >= 25
        await sleepers[2]
        assert clock.now_ns() == 30
        with pytest.raises(ValueError, match="never runs backwards"):
            clock.advance_to(29)

    run(work())


def test_it_runs_on_in_real_time_from_where_it_stands() -> None:
    async def work() -> None:
        clock, heard = VirtualClock(START_NS), []
        await clock.sleep_until(START_NS + 3600 * S)
        clock.on_advance(heard.append)
        waiting = [
            asyncio.create_task(clock.sleep_until(START_NS + 3600 * S + part * S // 50))
            for part in (2, 1)
        ]
        clock.run_on()
        clock.run_on()
        began_s, began_ns = time.monotonic(), clock.now_ns()
        assert clock.is_real
        assert began_ns >= START_NS + 3600 * S
        await asyncio.gather(*waiting)
        passed_s = (clock.now_ns() - began_ns) / 1e9
        assert passed_s >= 0.03
        assert passed_s <= time.monotonic() - began_s
        assert len(heard) >= 2
        with pytest.raises(ValueError, match="cannot be advanced"):
            clock.advance_to(START_NS + 9999 * S)

    run(work())


def test_sleepers_of_virtual_time_go_on_in_real_time() -> None:
    async def work() -> None:
        clock = VirtualClock(0)
        with clock.hold():
            waiting = [asyncio.create_task(clock.sleep_until(part * S // 100)) for part in (3, 1)]
            await asyncio.sleep(0.02)
            assert clock.now_ns() == 0
            clock.run_on()
            await asyncio.gather(*waiting)
        assert clock.now_ns() >= 3 * S // 100

    run(work())
