"""Modbus TCP: what is asked for, in how few requests, and what becomes of wrong answers."""

import asyncio
import itertools
import logging
import threading
from collections.abc import AsyncIterator, Callable, Coroutine
from typing import Any

import pytest

from runglight.errors import InputError
from runglight.taps import modbus_connection, open_tap
from runglight.taps.base import Batch, Gap, Tap
from runglight.taps.modbus_connection import (
    ILLEGAL_VALUE,
    ModbusConnection,
    ModbusEndpoint,
)
from runglight.taps.modbus_frame import FUNCTION, Request, data_of
from runglight.taps.modbus_names import Area
from tests.taps.benches.modbus import (
    READ_INPUT_REGISTERS,
    READ_INPUTS,
    WRITE_COIL,
    WRITE_REGISTER,
    ModbusBench,
)
from tests.taps.fakes import FakeClock
from tests.taps.scripted_server import (
    Answer,
    ScriptedServer,
    modbus_frame_bytes,
)
from tests.taps.silence import is_retried_for_ever

HANGS_S = 60


def run(test: Coroutine[Any, Any, None]) -> None:
    async def guarded() -> None:
        async with asyncio.timeout(HANGS_S):
            await test

    asyncio.run(guarded())


async def first_batch(url: str) -> tuple[Tap, Batch]:
    async with open_tap(url) as tap:
        return tap, await anext(aiter(tap))


def right(frame: bytes, fill: int = 0) -> bytes:
    """The reply of a device all of whose bytes are `fill`."""
    function, count = frame[7], int.from_bytes(frame[10:12], "big")
    size = -(-count // 8) if function in (1, 2) else 2 * count
    return frame[:4] + bytes([0, size + 3, frame[6], function, size]) + bytes([fill]) * size


def refusal(frame: bytes, code: int) -> bytes:
    return frame[:4] + bytes([0, 3, frame[6], frame[7] | 0x80, code])


def requests_of(frames: list[bytes]) -> list[tuple[int, int, int]]:
    """Function, first address and count of each request."""
    return [
        (frame[7], int.from_bytes(frame[8:10], "big"), int.from_bytes(frame[10:12], "big"))
        for frame in frames
    ]


def recording(answer: Answer = right) -> tuple[list[bytes], Answer]:
    frames: list[bytes] = []

    def answered(frame: bytes) -> bytes | None:
        frames.append(frame)
        return answer(frame)

    return frames, answered


# ---- What is read


def test_all_four_tables_with_their_values() -> None:
    async def test() -> None:
        bench = ModbusBench()
        await bench.start()
        try:
            await bench.write(WRITE_COIL, 9, [True])
            await bench.write(READ_INPUTS, 7, [True])
            await bench.write(READ_INPUT_REGISTERS, 1, [65_535])
            await bench.write(WRITE_REGISTER, 3, [513])
            tap, first = await first_batch(
                f"modbus://127.0.0.1:{bench.port}"
                "?coils=8-15&inputs=7&input_registers=0-1&holding=0,3"
            )
        finally:
            await bench.kill()
        values = {
            tap.signals[index].name: value
            for index, value in zip(first.signal_index, first.value.tolist(), strict=True)
        }
        ones = {name: value for name, value in values.items() if value}
        assert ones == {"00010": 1, "10008": 1, "30002": 65_535, "40004": 513}
        assert [signal.name for signal in tap.signals] == list(values)
        assert {signal.type for signal in tap.signals} == {"BOOL", "UINT"}

    run(test())


def test_contiguous_addresses_share_requests_up_to_the_limits_of_the_protocol() -> None:
    async def test() -> None:
        frames, answer = recording()
        async with ScriptedServer(answer, modbus_frame_bytes) as server:
            url = (
                f"modbus://127.0.0.1:{server.port}"
                "?coils=0-99,100-199,300&inputs=0-2499&holding=0-299"
            )
            tap, first = await first_batch(url)
        asked = requests_of(frames)
        once = [
            (2, 0, 2000), (2, 2000, 500), (1, 0, 200), (1, 300, 1),
            (3, 0, 125), (3, 125, 125), (3, 250, 50),
        ]  # fmt: skip
        # Once to find out what the device answers, then for the first scan.
        assert asked[: 2 * len(once)] == once * 2
        assert len(first) == len(tap.signals) == 2500 + 201 + 300

    run(test())


@pytest.mark.parametrize("code", [2, 3])
def test_a_smaller_limit_of_the_device_is_learned(code: int) -> None:
    """Some devices call a read that is too long an illegal value, others an illegal address."""

    async def test() -> None:
        def small(frame: bytes) -> bytes:
            count = int.from_bytes(frame[10:12], "big")
            if count <= 40:
                return right(frame, fill=1)
            refused.append(count)
            return refusal(frame, code)

        refused: list[int] = []
        frames, answer = recording(small)
        async with ScriptedServer(answer, modbus_frame_bytes) as server:
            url = f"modbus://127.0.0.1:{server.port}?holding=0-299&interval=0"
            async with open_tap(url) as tap:
                batches = aiter(tap)
                first = await anext(batches)
                assert first.value.tolist() == [257] * 300
                asked = len(frames)
                await anext(batches)
                if code == ILLEGAL_VALUE:
                    # Of 125 and 63 registers; whatever follows is asked for in 32.
                    assert len(refused) <= 3
                counts = {count for _, _, count in requests_of(frames[asked:])}
                assert max(counts) <= 40
                assert tap.connection.reconnects == 0

    run(test())


def test_addresses_the_device_has_not_are_named_with_the_mend() -> None:
    async def test() -> None:
        bench = ModbusBench(coils=16, holding=4)
        await bench.start()
        try:
            for query, missing, mend in (
                ("holding=0-9", "holding 4-9", "write holding=0-3"),
                ("coils=0-15&holding=8-9", "holding 8-9", "leave out holding"),
                ("coils=10-40", "coils 16-40", "write coils=10-15"),
            ):
                with pytest.raises(InputError, match="illegal data address") as refused:
                    await first_batch(f"modbus://127.0.0.1:{bench.port}?{query}")
                assert missing in str(refused.value)
                assert str(refused.value).endswith(mend)
        finally:
            await bench.kill()

    run(test())


def test_a_function_the_device_has_not_is_named() -> None:
    async def test() -> None:
        def no_coils(frame: bytes) -> bytes:
            return refusal(frame, 1) if frame[7] == FUNCTION[Area.COILS] else right(frame)

        async with ScriptedServer(no_coils, modbus_frame_bytes) as server:
            with pytest.raises(InputError, match="illegal function") as refused:
                await first_batch(f"modbus://127.0.0.1:{server.port}?coils=0-9&holding=0")
            assert "leave out coils" in str(refused.value)

    run(test())


# ---- Wrong answers


def short(frame: bytes) -> bytes:
    reply = right(frame, fill=0xFF)
    return reply[:5] + bytes([reply[5] - 1]) + reply[6:8] + bytes([reply[8] - 1]) + reply[9:-1]


def lying_about_its_length(frame: bytes) -> bytes:
    reply = right(frame, fill=0xFF)
    return reply[:8] + bytes([reply[8] + 2]) + reply[9:]


def other_unit(frame: bytes) -> bytes:
    reply = right(frame, fill=0xFF)
    return reply[:6] + bytes([reply[6] + 1]) + reply[7:]


def other_transaction(frame: bytes) -> bytes:
    reply = right(frame, fill=0xFF)
    return bytes([reply[0], reply[1] ^ 0xFF]) + reply[2:]


def other_function(frame: bytes) -> bytes:
    reply = right(frame, fill=0xFF)
    return reply[:7] + bytes([0x63]) + reply[8:]


def not_modbus(frame: bytes) -> bytes:
    return b"HTTP/1.1 400 Bad Request\r\n\r\n"


def busy(frame: bytes) -> bytes:
    return refusal(frame, 6)


def no_such_address(frame: bytes) -> bytes:
    return refusal(frame, 2)


WRONG = [
    short,
    lying_about_its_length,
    other_unit,
    other_transaction,
    other_function,
    not_modbus,
    busy,
    no_such_address,
]


class Sometimes:
    """Right answers, but for those that a test asks to be wrong."""

    def __init__(self, wrong: Answer) -> None:
        self.wrong = wrong
        self.wrong_ones = 0

    def __call__(self, frame: bytes) -> bytes | None:
        if self.wrong_ones:
            self.wrong_ones -= 1
            return self.wrong(frame)
        return right(frame)


async def watched(
    server: ScriptedServer,
    spoil: Callable[[], None],
    until: Callable[[list[Batch]], bool],
    timeout: str = "10s",
) -> tuple[Tap, list[Batch]]:
    """The batches after the first, from `spoil` on."""
    seen: list[Batch] = []
    async with open_tap(f"modbus://127.0.0.1:{server.port}?coils=0-9&timeout={timeout}") as tap:
        batches = aiter(tap)
        assert (await anext(batches)).image
        spoil()
        async for batch in batches:
            seen.append(batch)
            if until(seen):
                break
        state = tap.connection
    tap.connection = state
    return tap, seen


@pytest.mark.parametrize("wrong", WRONG, ids=lambda wrong: wrong.__name__)
def test_one_wrong_answer_is_asked_again(wrong: Answer) -> None:
    async def test() -> None:
        answer = Sometimes(wrong)
        async with ScriptedServer(answer, modbus_frame_bytes) as server:

            def spoil() -> None:
                answer.wrong_ones = 1

            tap, seen = await watched(
                server, spoil, lambda seen: not answer.wrong_ones and len(seen) > 2
            )
            assert server.connections == 1
            assert not any(len(batch) or batch.marks for batch in seen)
            assert tap.connection.reconnects == 0

    run(test())


@pytest.mark.parametrize("wrong", WRONG, ids=lambda wrong: wrong.__name__)
def test_two_wrong_answers_are_a_gap_and_never_values(
    wrong: Answer, capfd: pytest.CaptureFixture[str]
) -> None:
    async def test() -> None:
        answer = Sometimes(wrong)
        async with ScriptedServer(answer, modbus_frame_bytes) as server:

            def spoil() -> None:
                answer.wrong_ones = 2

            tap, seen = await watched(server, spoil, lambda seen: bool(seen[-1].marks))
            (gap,) = seen[-1].marks
            assert isinstance(gap, Gap)
            assert "two wrong answers" in gap.reason
            assert seen[-1].image
            assert not seen[-1].value.any()
            assert not any(len(batch) for batch in seen[:-1])
            assert server.connections == 2
            assert tap.connection.reconnects == 1

    run(test())
    # Neither pymodbus nor the event loop says a word of it.
    assert capfd.readouterr() == ("", "")


def test_a_connection_that_is_dropped_is_a_gap() -> None:
    async def test() -> None:
        async with ScriptedServer(right, modbus_frame_bytes) as server:
            _, seen = await watched(server, server.drop, lambda seen: bool(seen[-1].marks))
            (gap,) = seen[-1].marks
            assert isinstance(gap, Gap)
            assert "closed by the other side" in gap.reason
            assert seen[-1].image

    run(test())


def test_a_device_that_falls_silent_is_asked_over_a_new_connection() -> None:
    """A half-open connection: the other side is gone and did not say so."""

    async def test() -> None:
        silent = False

        def answer(frame: bytes) -> bytes | None:
            return None if silent and server.connections == 1 else right(frame)

        def spoil() -> None:
            nonlocal silent
            silent = True

        async with ScriptedServer(answer, modbus_frame_bytes) as server:
            _, seen = await watched(server, spoil, lambda seen: bool(seen[-1].marks), "300ms")
            (gap,) = seen[-1].marks
            assert isinstance(gap, Gap)
            assert "no reply in 0.3 s" in gap.reason
            assert gap.end_ns - gap.start_ns >= 300_000_000
            assert server.connections == 2

    run(test())


def test_a_device_that_accepts_and_never_answers_is_retried_for_ever() -> None:
    run(is_retried_for_ever("modbus", "coils=0-9&timeout=50ms", r"no reply in 0\.05 s"))


def test_a_reply_in_pieces_is_put_together() -> None:
    async def test() -> None:
        async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            try:
                while frame := await reader.read(12):
                    for byte in right(frame, fill=0x55):
                        writer.write(bytes([byte]))
                        await writer.drain()
                        await asyncio.sleep(0)
            finally:
                writer.close()

        server = await asyncio.start_server(serve, "127.0.0.1", 0)
        port = server.sockets[0].getsockname()[1]
        _, first = await first_batch(f"modbus://127.0.0.1:{port}?coils=0-9")
        assert first.value.tolist() == [1, 0] * 5
        server.close()

    run(test())


def test_a_cancellation_at_the_moment_of_the_reply_is_heeded(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    async def test() -> None:
        async with ScriptedServer(right, modbus_frame_bytes) as server:
            connection = ModbusConnection(ModbusEndpoint("127.0.0.1", server.port, 1, 5.0))
            await connection.open()
            reading = asyncio.ensure_future(connection.read(Request(Area.COILS, 0, 8)))

            def cancelling(frame: bytes, request: Request) -> bytes:
                reading.cancel()
                return data_of(frame, request)

            monkeypatch.setattr(modbus_connection, "data_of", cancelling)
            await asyncio.wait([reading])
            connection.close()
            assert reading.cancelled()

    run(test())


# ---- Where it runs


def test_in_a_simulated_time_it_scans_on_that_clock_in_the_readers_loop() -> None:
    async def test() -> None:
        bench = ModbusBench()
        await bench.start()
        clock = FakeClock()
        threads = threading.active_count()
        try:
            async with open_tap(f"{bench.url}&interval=10ms", clock=clock) as tap:
                batches: AsyncIterator[Batch] = aiter(tap)
                scans: list[int] = []
                for number in range(30):
                    batch = await anext(batches)
                    scans.extend(batch.scan_ns.tolist())
                    assert threading.active_count() == threads
                    if number == 10:
                        await bench.change(1)
                        asked = clock.now_ns()
                    if number == 11:
                        assert batch.value.tolist() == [1]
                        assert batch.time_ns[0] == asked + 10_000_000
            steps = {later - earlier for earlier, later in itertools.pairwise(scans)}
            assert steps == {10_000_000}
        finally:
            await bench.kill()

    run(test())


def test_as_fast_as_it_goes_needs_a_time_of_its_own() -> None:
    async def test() -> None:
        tap = open_tap("modbus://127.0.0.1:1?coils=0&interval=0", clock=FakeClock())
        with pytest.raises(InputError, match="interval=0"):
            await anext(aiter(tap))

    run(test())


def test_pymodbus_has_nothing_to_say_to_the_user() -> None:
    handlers = logging.getLogger("pymodbus").handlers
    assert any(isinstance(handler, logging.NullHandler) for handler in handlers)


# ---- Options


@pytest.mark.parametrize(
    ("query", "said"),
    [
        ("", "says nothing to read"),
        ("coils=0-9&unit=300", "unit=300 is no unit"),
        ("coils=0-9&unit=x", "unit=x is no unit"),
        ("coils=9-0", "runs backwards"),
        ("coils=0-9&timeout=0", "timeout must be above zero"),
        ("coils=0-9&timeout=soon", "timeout: 'soon' is not a duration"),
        ("coils=0-9&interval=often", "interval: 'often' is not a duration"),
        ("coils=0-9&names=opnplc", "did you mean openplc"),
        ("coil=0-9", "did you mean coils"),
    ],
)
def test_options_that_cannot_be_are_refused(query: str, said: str) -> None:
    with pytest.raises(InputError, match=said) as refused:
        open_tap(f"modbus://plc?{query}")
    assert str(refused.value).startswith("modbus://plc")
    assert "\n" not in str(refused.value)


def test_a_request_knows_the_length_of_its_reply() -> None:
    assert Request(Area.COILS, 0, 9).reply_bytes == 2
    assert Request(Area.HOLDING, 0, 9).reply_bytes == 18
