"""The Sparkplug B tap, with a real broker and an edge node of our own."""

import asyncio
from collections.abc import Callable

import pytest

from runglight.errors import InputError
from runglight.taps import open_tap
from runglight.taps.base import ConnectionState
from tests.taps.benches.sparkplug import SparkplugBench
from tests.taps.cable import Cable
from tests.taps.listening import HANG_S, Listener, check_order
from tests.taps.sparkplug_edge import Edge, metric, payload

CLAMP, STEP = "Cell-Station-Clamp", "Cell-Station-Step"


def run(test: Callable[[], object]) -> None:
    asyncio.run(test())  # type: ignore[arg-type]


async def eventually(seen: Callable[[], object]) -> None:
    async with asyncio.timeout(HANG_S):
        while not seen():
            await asyncio.sleep(0.01)


def test_a_birth_that_was_missed_is_asked_for_and_makes_the_image() -> None:
    async def test() -> None:
        async with (
            SparkplugBench() as bench,
            Listener(open_tap(bench.group_url.replace("timeout=1", "timeout=20s"))) as listener,
        ):
            # It is born already: its data make it known, and it is asked.
            while not listener.images:
                await bench.edge.put("Step", 5)
                await asyncio.sleep(0.1)
            assert bench.edge.asked >= 1
            assert listener.images[0] == {CLAMP: 0, STEP: 5}
            signals = {signal.name: signal for signal in listener.tap.signals}
            assert signals[STEP].type == "INT"
            assert signals[STEP].address == "line/Cell/Station:Step"
            assert any("Cell-Temperature" in line for line in listener.tap.notices)
            await bench.edge.put("Step", -7)
            await bench.edge.put("Clamp", 1)
            await listener.until(lambda: listener.changes(CLAMP) == [1])
            assert listener.changes(STEP)[-1] == -7
            check_order(listener.batches)

    run(test)


def test_the_rebirth_request_is_all_that_is_published() -> None:
    async def test() -> None:
        async with SparkplugBench() as bench:
            async with Listener(open_tap(bench.url)) as listener:
                await listener.until(lambda: listener.images)
            assert {topic for topic, _ in bench.edge.commands} == {"spBv1.0/line/NCMD/Cell"}
            assert bench.edge.asked == len(bench.edge.commands) == 1

    run(test)


def test_rebirth_can_be_forbidden() -> None:
    async def test() -> None:
        async with SparkplugBench() as bench:
            async with Listener(open_tap(bench.url + "&rebirth=no")) as listener:
                await listener.until(lambda: listener.images)
                assert listener.images == [{}]
                await bench.edge.put("Step", 1)
                await bench.edge.birth()
                await listener.until(lambda: listener.changes(STEP))
                bench.edge.lose()
                await bench.edge.put("Step", 2)
                await listener.until(lambda: listener.gaps)
                await listener.until(lambda: listener.changes(STEP)[-1] == 2)
                check_order(listener.batches)
            assert bench.edge.commands == []

    run(test)


def test_a_lost_message_is_a_gap_until_the_rebirth() -> None:
    async def test() -> None:
        async with (
            SparkplugBench() as bench,
            Listener(open_tap(bench.url)) as listener,
        ):
            await listener.until(lambda: listener.images)
            bench.edge.values["Clamp"] = 1
            bench.edge.lose()
            tap_asked = bench.edge.asked
            # More than the pause between two requests does not have to pass: it was answered.
            await bench.edge.put("Step", 3)
            await listener.until(lambda: len(listener.images) == 2)
            assert bench.edge.asked == tap_asked + 1
            assert listener.images[1] == {CLAMP: 1, STEP: 3}
            assert listener.gaps
            assert "Cell" in listener.gaps[0].reason
            assert listener.changes(CLAMP) == []
            check_order(listener.batches)

    run(test)


def test_sequence_numbers_go_round() -> None:
    async def test() -> None:
        async with (
            SparkplugBench() as bench,
            Listener(open_tap(bench.url)) as listener,
        ):
            await listener.until(lambda: listener.images)
            for step in range(600):
                await bench.edge.put("Step", step)
            await listener.until(lambda: 599 in listener.changes(STEP))
            assert listener.changes(STEP) == list(range(600))
            assert listener.gaps == []

    run(test)


def test_a_device_that_died_is_a_gap_when_it_is_born_again() -> None:
    async def test() -> None:
        async with (
            SparkplugBench() as bench,
            Listener(open_tap(bench.url)) as listener,
        ):
            await listener.until(lambda: listener.images)
            await bench.edge.publish("DDEATH", "Station", payload([], bench.edge._next()))
            bench.edge.values["Step"] = 8
            await bench.edge.device_birth()
            await listener.until(lambda: len(listener.images) == 2)
            assert listener.images[1] == {CLAMP: 0, STEP: 8}
            assert "Cell/Station" in listener.gaps[0].reason
            assert listener.changes(STEP) == []

    run(test)


def test_a_node_that_died_is_a_gap_and_an_old_will_is_not_its_death() -> None:
    async def test() -> None:
        async with (
            SparkplugBench() as bench,
            Listener(open_tap(bench.url)) as listener,
        ):
            await listener.until(lambda: listener.images)
            await bench.edge.publish("NDEATH", "", payload([metric(99, "UInt64", name="bdSeq")]))
            await bench.edge.put("Step", 1)
            await listener.until(lambda: listener.changes(STEP) == [1])
            assert listener.gaps == []
            await bench.edge.stop()
            bench.edge.bd_seq += 1
            bench.edge.values["Step"] = 2
            await bench.edge.start()
            await listener.until(lambda: len(listener.images) == 2)
            assert listener.images[1] == {CLAMP: 0, STEP: 2}
            assert len(listener.gaps) == 1
            assert listener.changes(STEP) == [1]

    run(test)


def test_historical_null_and_undecodable_are_said_and_change_nothing() -> None:
    async def test() -> None:
        async with (
            SparkplugBench() as bench,
            Listener(open_tap(bench.url)) as listener,
        ):
            await listener.until(lambda: listener.images)
            await bench.edge.put("Step", 50, historical=True)
            await bench.edge.publish(
                "DDATA", "Station", payload([metric(None, alias=11)], bench.edge._next())
            )
            await bench.edge.publish("DDATA", "Station", b"\xff\xff")
            await bench.edge.put("Step", 4)
            await listener.until(lambda: listener.changes(STEP) == [4])
            said = "\n".join(listener.tap.notices)
            assert f"history of {STEP}" in said
            assert "is null" in said
            assert "spBv1.0/line/DDATA/Cell/Station: ends in the middle" in said

    run(test)


def test_a_killed_broker_is_a_gap_and_the_births_follow() -> None:
    async def test() -> None:
        async with (
            SparkplugBench() as bench,
            Listener(open_tap(bench.url)) as listener,
        ):
            await listener.until(lambda: listener.images)
            bench.keeps = True
            await bench.kill()
            await eventually(lambda: listener.tap.connection.state is ConnectionState.RETRYING)
            await bench.put(STEP, 6)
            await bench.start()
            await listener.until(lambda: len(listener.images) >= 2)
            await listener.until(
                lambda: listener.images[-1].get(STEP) == 6 or 6 in listener.changes(STEP)
            )
            assert listener.gaps
            check_order(listener.batches)

    run(test)


def test_a_cut_cable_is_noticed_by_the_keepalive() -> None:
    async def test() -> None:
        async with SparkplugBench() as bench, Cable(bench.port) as cable:
            url = bench.url_at(cable.port)
            async with Listener(open_tap(url)) as listener:
                await listener.until(lambda: listener.images)
                cable.cut()
                await eventually(lambda: listener.tap.connection.state is ConnectionState.RETRYING)
                cable.mend()
                await listener.until(lambda: len(listener.images) == 2)
                assert listener.images[1] == {CLAMP: 0, STEP: 0}

    run(test)


def test_check_answers_from_the_births() -> None:
    async def test() -> None:
        async with SparkplugBench() as bench:
            answers = await open_tap(bench.url).check()
            assert {answer.signal.name: answer.value for answer in answers} == {CLAMP: 0, STEP: 0}

    run(test)


def test_a_node_that_does_not_answer_is_not_asked_all_the_time() -> None:
    async def test() -> None:
        async with SparkplugBench() as bench:
            await bench.edge.stop()
            bench.edge = Edge(bench.broker.port, answers=False)
            await bench.edge.start()
            async with Listener(open_tap(bench.group_url)) as listener:
                await listener.until(lambda: listener.images)
                for step in range(50):
                    await bench.edge.put("Step", step)
                await eventually(lambda: bench.edge.asked)
                assert bench.edge.asked == 1

    run(test)


def test_a_path_that_is_no_group() -> None:
    with pytest.raises(InputError, match="GROUP/NODE"):
        open_tap("sparkplug://127.0.0.1/a/b/c")
    with pytest.raises(InputError, match="yes or no"):
        open_tap("sparkplug://127.0.0.1/a?rebirth=maybe")
