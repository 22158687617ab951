"""S7: what is asked for, in how few requests, and what becomes of wrong answers."""

import asyncio
import itertools
import threading
from collections.abc import Callable, Coroutine
from typing import Any

import pytest
from snap7.connection import ISOTCPConnection
from snap7.error import S7TimeoutError
from snap7.type import SrvArea

from runglight.errors import InputError
from runglight.taps import open_tap
from runglight.taps.base import Batch, Gap
from tests.taps.benches.s7 import S7Bench
from tests.taps.fakes import FakeClock
from tests.taps.scripted_s7 import (
    READ,
    ScriptedS7,
    data_item,
    items_of,
    read_reply,
    reply,
    s7_frame_bytes,
)
from tests.taps.scripted_server import ScriptedServer
from tests.taps.silence import is_retried_for_ever

HANGS_S = 60
PE, PA, DB = 0x81, 0x82, 0x84


def run(test: Coroutine[Any, Any, None]) -> None:
    async def guarded() -> None:
        async with asyncio.timeout(HANGS_S):
            await test

    asyncio.run(guarded())


def test_every_bit_is_a_signal_of_its_own() -> None:
    async def test() -> None:
        bench = S7Bench()
        await bench.start()
        try:
            bench.write(SrvArea.PE, 2, 0b1000_0001)
            bench.write(SrvArea.PA, 0, 0b0000_0010)
            bench.write(SrvArea.MK, 1, 0b0000_1000)
            bench.write(SrvArea.DB, 4, 0b0100_0000)
            async with open_tap(bench.url) as tap:
                first = await anext(aiter(tap))
                ones = [tap.signals[index].name for index in first.signal_index[first.value == 1]]
                assert ones == ["I2.0", "I2.7", "Q0.1", "M1.3", "DB1.DBX4.6"]
                classes = {signal.name: signal.signal_class for signal in tap.signals}
                assert [classes[name] for name in ones[1:]] == [
                    "input",
                    "output",
                    "memory",
                    "memory",
                ]
        finally:
            await bench.kill()

    run(test())


def test_all_areas_share_one_request_where_the_pdu_is_large_enough() -> None:
    async def test() -> None:
        plc = ScriptedS7(read_reply, pdu_bytes=480)
        async with ScriptedServer(plc, s7_frame_bytes) as server:
            url = f"s7://127.0.0.1:{server.port}?pa=0-3&pe=0-26&db2=4-9&db1=0-9"
            async with open_tap(url) as tap:
                await anext(aiter(tap))
        assert items_of(plc.reads[-1]) == [
            (PE, 0, 0, 27),
            (PA, 0, 0, 4),
            (DB, 1, 0, 10),
            (DB, 2, 4, 6),
        ]

    run(test())


def test_long_areas_are_split_at_the_size_the_plc_grants() -> None:
    async def test() -> None:
        plc = ScriptedS7(lambda frame: read_reply(frame, fill=0x0F), pdu_bytes=240)
        async with ScriptedServer(plc, s7_frame_bytes) as server:
            url = f"s7://127.0.0.1:{server.port}?pe=0-1&db1=0-599"
            async with open_tap(url) as tap:
                first = await anext(aiter(tap))
                assert first.value.tolist() == [1, 1, 1, 1, 0, 0, 0, 0] * 602
        for frame in plc.reads:
            assert len(frame) <= 240 + 7
            assert len(read_reply(frame)) <= 240 + 7

    run(test())


def test_rack_and_slot_are_called() -> None:
    async def test() -> None:
        plc = ScriptedS7(read_reply)
        async with ScriptedServer(plc, s7_frame_bytes) as server:
            for query in ("pe=0", "pe=0&rack=1&slot=3", "pe=0&slot=1"):
                await open_tap(f"s7://127.0.0.1:{server.port}?{query}").check()
        assert plc.called_tsaps == [b"\x01\x02", b"\x01\x23", b"\x01\x01"]

    run(test())


@pytest.mark.parametrize(
    ("query", "missing", "mend"),
    [
        ("pe=0-5", "pe 3-5", "write pe=0-2"),
        ("db1=0-9", "db1 5-9", "write db1=0-4, or switch off 'optimized block access'"),
        ("pe=0-2&db7=0-9", "db7 0-9", "leave out db7, or switch off 'optimized block access'"),
    ],
)
def test_bytes_the_plc_has_not_are_named_with_the_mend(query: str, missing: str, mend: str) -> None:
    async def test() -> None:
        bench = S7Bench()
        await bench.start()
        try:
            async with open_tap(f"s7://127.0.0.1:{bench.port}?{query}") as tap:
                with pytest.raises(InputError) as refused:
                    await anext(aiter(tap))
        finally:
            await bench.kill()
        assert f"does not give {missing} (" in str(refused.value)
        assert mend in str(refused.value)

    run(test())


def test_a_cpu_that_permits_no_reading_is_told_with_the_mend() -> None:
    async def test() -> None:
        def protected(frame: bytes) -> bytes:
            return reply(frame, b"", error=b"\x81\x04")

        async with ScriptedServer(ScriptedS7(protected), s7_frame_bytes) as server:
            tap = open_tap(f"s7://127.0.0.1:{server.port}?pe=0")
            with pytest.raises(InputError, match="PUT/GET"):
                await anext(aiter(tap))
            await tap.close()

    run(test())


# ---- Wrong answers


def short(frame: bytes) -> bytes:
    return reply(frame, bytes([READ, 1]), data_item(1, 0xFF))


def long(frame: bytes) -> bytes:
    return reply(frame, bytes([READ, 1]), data_item(3, 0xFF))


def cut(frame: bytes) -> bytes:
    return reply(frame, bytes([READ, 1]), data_item(2, 0xFF)[:5])


def two_items(frame: bytes) -> bytes:
    return reply(frame, bytes([READ, 2]), data_item(2, 0xFF) * 2)


def other_function(frame: bytes) -> bytes:
    return reply(frame, bytes([5, 1]), data_item(2, 0xFF))


def no_data(frame: bytes) -> bytes:
    return reply(frame, bytes([READ, 1]))


def hardware_error(frame: bytes) -> bytes:
    return reply(frame, bytes([READ, 1]), b"\x01\0\0\0")


def no_such_address(frame: bytes) -> bytes:
    return reply(frame, bytes([READ, 1]), b"\x05\0\0\0")


def error_class(frame: bytes) -> bytes:
    return reply(frame, b"", error=b"\x85\0")


def garbage(frame: bytes) -> bytes:
    return b"\x03\0\0\x10" + bytes(range(12))


WRONG = [
    short,
    long,
    cut,
    two_items,
    other_function,
    no_data,
    hardware_error,
    no_such_address,
    error_class,
]
Wrong = Callable[[bytes], bytes]


async def spoiled(wrong: Wrong, times: int) -> tuple[list[Batch], int]:
    """The batches after `times` wrong answers (the last one tells of them), and connections."""
    left = 0

    def on_read(frame: bytes) -> bytes:
        nonlocal left
        if left:
            left -= 1
            return wrong(frame)
        return read_reply(frame)

    seen: list[Batch] = []
    async with ScriptedServer(ScriptedS7(on_read), s7_frame_bytes) as server:
        async with open_tap(f"s7://127.0.0.1:{server.port}?pe=0-1&timeout=10s") as tap:
            batches = aiter(tap)
            assert (await anext(batches)).image
            left = times
            async for batch in batches:
                seen.append(batch)
                if batch.marks or (times == 1 and not left and len(seen) > 2):
                    break
        return seen, server.connections


@pytest.mark.parametrize("wrong", WRONG, ids=lambda wrong: wrong.__name__)
def test_one_wrong_answer_is_asked_again(wrong: Wrong) -> None:
    async def test() -> None:
        seen, connections = await spoiled(wrong, 1)
        assert connections == 1
        assert not any(len(batch) or batch.marks for batch in seen)

    run(test())


@pytest.mark.parametrize("wrong", [*WRONG, garbage], ids=lambda wrong: wrong.__name__)
def test_more_wrong_answers_are_a_gap_and_never_values(
    wrong: Wrong, capfd: pytest.CaptureFixture[str]
) -> None:
    async def test() -> None:
        seen, connections = await spoiled(wrong, 2)
        (gap,) = seen[-1].marks
        assert isinstance(gap, Gap)
        assert gap.reason
        assert seen[-1].image
        assert not seen[-1].value.any()
        assert not any(len(batch) for batch in seen[:-1])
        assert connections >= 2

    run(test())
    assert capfd.readouterr() == ("", "")


def test_a_plc_that_falls_silent_is_asked_over_a_new_connection() -> None:
    async def test() -> None:
        silent = False

        def on_read(frame: bytes) -> bytes | None:
            return None if silent and server.connections == 1 else read_reply(frame)

        async with ScriptedServer(ScriptedS7(on_read), s7_frame_bytes) as server:
            tap = open_tap(f"s7://127.0.0.1:{server.port}?pe=0-1&timeout=200ms")
            batches = aiter(tap)
            await anext(batches)
            silent = True
            async for batch in batches:
                if batch.marks:
                    break
            await tap.close()
            (gap,) = batch.marks
            assert isinstance(gap, Gap)
            assert "no reply in 0.2 s" in gap.reason
            assert batch.image

    run(test())


def test_a_host_that_accepts_and_never_answers_is_retried_for_ever() -> None:
    run(is_retried_for_ever("s7", "pe=0&timeout=50ms", r"127\.0\.0\.1"))


def test_connecting_takes_no_longer_than_the_time_out(monkeypatch: pytest.MonkeyPatch) -> None:
    waits: list[float] = []

    def connect(wire: ISOTCPConnection, timeout: float = 5.0) -> None:
        waits.append(timeout)
        raise S7TimeoutError("no")

    monkeypatch.setattr(ISOTCPConnection, "connect", connect)
    for query, wait_s in (("pe=0", 0.5), ("pe=0&timeout=2s", 2.0)):
        with pytest.raises(InputError):
            asyncio.run(open_tap(f"s7://127.0.0.1?{query}").check())
        assert waits.pop() == wait_s


# ---- Where it runs


def test_in_a_simulated_time_it_scans_on_that_clock_beside_the_readers_loop() -> None:
    async def test() -> None:
        bench = S7Bench()
        await bench.start()
        clock = FakeClock()
        try:
            async with open_tap(f"{bench.url}&interval=10ms", clock=clock) as tap:
                batches = aiter(tap)
                scans = (await anext(batches)).scan_ns.tolist()
                await bench.change(1)
                asked = clock.now_ns()
                changed = await anext(batches)
                assert changed.time_ns.tolist() == [asked + 10_000_000]
                scans = changed.scan_ns.tolist()
                for _ in range(10):
                    scans += (await anext(batches)).scan_ns.tolist()
                assert len(scans) > 20
                assert {later - earlier for earlier, later in itertools.pairwise(scans)} == {
                    10_000_000
                }
        finally:
            await bench.kill()
        assert not [thread for thread in threading.enumerate() if "runglight-s7" in thread.name]

    run(test())


def test_scanning_as_fast_as_it_goes_can_be_closed() -> None:
    async def test() -> None:
        bench = S7Bench()
        await bench.start()
        try:
            async with open_tap(f"{bench.url}&interval=0") as tap:
                batches = aiter(tap)
                await anext(batches)
                assert len((await anext(batches)).scan_ns) > 10
                assert any("runglight-s7" in thread.name for thread in threading.enumerate())
            assert not any("runglight-s7" in thread.name for thread in threading.enumerate())
        finally:
            await bench.kill()

    run(test())


# ---- Options


@pytest.mark.parametrize(
    ("query", "said"),
    [
        ("", "says nothing to read"),
        ("pe=0-9&rack=8", "rack=8 is none"),
        ("pe=0-9&slot=x", "slot=x is none"),
        ("db0=0-9", "numbered from 1"),
        ("db1=a", "db1: 'a' is no range"),
        ("dbx=0-9", "unknown option 'dbx'"),
        ("db=0-9", "unknown option 'db'"),
        ("db*=0-9", "unknown option"),
        ("pe=0-70000", "addresses end at 65535"),
        ("pe=0-9&timeout=0s", "timeout must be above zero"),
    ],
)
def test_options_that_cannot_be_are_refused(query: str, said: str) -> None:
    with pytest.raises(InputError) as refused:
        open_tap(f"s7://plc?{query}")
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)
