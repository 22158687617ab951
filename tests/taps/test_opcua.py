"""The OPC UA tap against asyncua's server."""

import asyncio
from collections.abc import Callable
from datetime import UTC, datetime, timedelta

import pytest
from asyncua import Server, ua

from runglight.errors import InputError
from runglight.taps import open_tap
from runglight.taps.base import ConnectionState
from tests.taps.benches.bench import free_port
from tests.taps.benches.opcua import OpcUaBench
from tests.taps.cable import Cable
from tests.taps.listening import Listener, check_order


class Mixed(OpcUaBench):
    """Also has what is no boolean or integer, a folder, and two nodes of one name."""

    async def more(self, server: Server) -> None:
        at = self.namespace
        await self.station.add_variable(ua.NodeId("Pressure", at), f"{at}:Pressure", 4.7)
        await self.station.add_variable(ua.NodeId("Recipe", at), f"{at}:Recipe", "A7")
        await self.station.add_variable(ua.NodeId("Words", at), f"{at}:Words", [1, 2])
        await self.station.add_property(ua.NodeId("Unit", at), f"{at}:Unit", 3)
        inner = await self.station.add_object(ua.NodeId("Inner", at), f"{at}:Inner")
        await inner.add_variable(ua.NodeId("Big", at), f"{at}:Big", 1 << 40, ua.VariantType.Int64)
        await inner.add_variable(ua.NodeId("Twin1", at), f"{at}:Twin", True)
        await inner.add_variable(ua.NodeId("Twin2", at), f"{at}:Twin", False)


def run(test: Callable[[], object]) -> None:
    asyncio.run(test())  # type: ignore[arg-type]


def test_browse_finds_booleans_and_integers_and_says_what_is_left_out() -> None:
    async def test() -> None:
        async with Mixed() as bench, Listener(open_tap(bench.url)) as listener:
            await listener.until(lambda: listener.images)
            tap = listener.tap
            at = bench.namespace
            assert listener.images[0] == {
                "Station-Clamp": 0,
                "Station-Step": 0,
                "Station-Inner-Big": 1 << 40,
                "Station-Inner-Twin": 1,
                f"Station-Inner-Twin(ns={at};s=Twin2)": 0,
            }
            signals = {signal.name: signal for signal in tap.signals}
            assert signals["Station-Step"].address == f"ns={at};s=Step"
            assert signals["Station-Step"].type == "INT"
            assert signals["Station-Clamp"].type == "BOOL"
            assert [line.partition(":")[0] for line in tap.notices] == [
                "Station-Pressure",
                "Station-Recipe",
                "Station-Words",
            ]

    run(test)


def test_browse_below_one_node() -> None:
    async def test() -> None:
        async with Mixed() as bench:
            url = f"{bench.url}&browse=ns={bench.namespace};s=Inner"
            async with Listener(open_tap(url)) as listener:
                await listener.until(lambda: listener.images)
                assert set(listener.images[0]) > {"Big", "Twin"}

    run(test)


def test_every_change_between_two_publishings_is_seen_in_order() -> None:
    async def test() -> None:
        async with OpcUaBench() as bench, Listener(open_tap(bench.url)) as listener:
            await listener.until(lambda: listener.images)
            for step in range(1, 31):
                await bench.put("Station-Step", step)
            await listener.until(lambda: 30 in listener.changes("Station-Step"))
            assert listener.changes("Station-Step") == list(range(1, 31))
            check_order(listener.batches)

    run(test)


def test_a_queue_that_ran_over_is_said_and_is_a_gap() -> None:
    """asyncua's server throws away silently; others say so in the status of what they kept."""

    async def test() -> None:
        async with OpcUaBench() as bench, Listener(open_tap(bench.url)) as listener:
            await listener.until(lambda: listener.images)
            await bench.nodes["Step"].write_value(
                ua.DataValue(ua.Variant(30, ua.VariantType.Int16), ua.StatusCode(0x0480))
            )
            await listener.until(lambda: len(listener.images) > 1)
            assert listener.images[1] == {"Station-Clamp": 0, "Station-Step": 30}
            assert listener.changes("Station-Step") == []
            assert "queue ran over" in listener.gaps[0].reason
            assert any("raise queue=50" in line for line in listener.tap.notices)
            check_order(listener.batches)

    run(test)


def test_source_time_stamps_are_taken_and_sorted() -> None:
    async def test() -> None:
        async with OpcUaBench() as bench, Listener(open_tap(f"{bench.url}&reorder=2s")) as listener:
            await listener.until(lambda: listener.images)
            # Old enough that the image is older still.
            await asyncio.sleep(0.4)
            now = datetime.now(UTC) - timedelta(milliseconds=300)
            for name, value, later_ms in (("Step", 7, 50), ("Clamp", True, 20)):
                await bench.nodes[name].write_value(
                    ua.DataValue(
                        ua.Variant(
                            value,
                            ua.VariantType.Boolean if value is True else ua.VariantType.Int16,
                        ),
                        SourceTimestamp=now + timedelta(milliseconds=later_ms),
                    )
                )
            await listener.until(lambda: listener.changes("Station-Step"))
            [step_ns], [clamp_ns] = (
                listener.times("Station-Step"),
                listener.times("Station-Clamp"),
            )
            assert step_ns - clamp_ns == 30_000_000
            assert abs(step_ns / 1e9 - (now + timedelta(milliseconds=50)).timestamp()) < 1e-5
            check_order(listener.batches)

    run(test)


def test_a_bad_status_holds_the_signal_and_a_return_elsewhere_is_a_gap() -> None:
    async def test() -> None:
        async with OpcUaBench() as bench, Listener(open_tap(bench.url)) as listener:
            await listener.until(lambda: listener.images)
            await bench.put("Station-Step", 3)
            await bench.nodes["Clamp"].write_value(
                ua.DataValue(StatusCode=ua.StatusCode(ua.StatusCodes.BadSensorFailure))
            )
            await listener.until(lambda: any("Clamp" in line for line in listener.tap.notices))
            await listener.until(lambda: listener.changes("Station-Step") == [3])
            assert listener.changes("Station-Clamp") == []
            await bench.put("Station-Clamp", 1)
            await listener.until(lambda: len(listener.images) == 2)
            assert listener.images[1] == {"Station-Clamp": 1, "Station-Step": 3}
            assert "Station-Clamp was BadSensorFailure" in listener.gaps[0].reason
            assert not any("Clamp" in line for line in listener.tap.notices)
            check_order(listener.batches)

    run(test)


def test_a_killed_server_is_a_gap_and_the_next_image_follows() -> None:
    async def test() -> None:
        async with OpcUaBench() as bench, Listener(open_tap(bench.url)) as listener:
            await listener.until(lambda: listener.images)
            await bench.put("Station-Step", 1)
            await listener.until(lambda: listener.changes("Station-Step"))
            bench.keeps = True
            await bench.kill()
            while listener.tap.connection.state is not ConnectionState.RETRYING:
                await asyncio.sleep(0.01)
            assert listener.tap.connection.reason
            await bench.put("Station-Step", 2)
            await bench.start()
            await listener.until(lambda: len(listener.images) == 2)
            assert listener.images[1] == {"Station-Clamp": 0, "Station-Step": 2}
            assert listener.changes("Station-Step") == [1]
            [gap] = listener.gaps
            assert gap.start_ns >= listener.times("Station-Step")[-1]
            assert gap.end_ns > gap.start_ns
            assert listener.tap.connection.reconnects == 1
            await bench.put("Station-Step", 3)
            await listener.until(lambda: listener.changes("Station-Step") == [1, 3])
            check_order(listener.batches)

    run(test)


def test_a_cut_cable_is_noticed_without_a_word_from_the_server() -> None:
    async def test() -> None:
        async with (
            OpcUaBench() as bench,
            Cable(bench.port) as cable,
            Listener(open_tap(bench.url_at(cable.port))) as listener,
        ):
            await listener.until(lambda: listener.images)
            cable.cut()
            while listener.tap.connection.state is not ConnectionState.RETRYING:
                await asyncio.sleep(0.01)
            await bench.put("Station-Step", 9)
            cable.mend()
            await listener.until(lambda: len(listener.images) == 2)
            assert listener.images[1]["Station-Step"] == 9
            assert len(listener.gaps) == 1
            check_order(listener.batches)

    run(test)


def test_a_server_that_is_not_there_is_awaited() -> None:
    async def test() -> None:
        bench = OpcUaBench()
        async with Listener(open_tap(bench.url)) as listener:
            while listener.tap.connection.state is not ConnectionState.RETRYING:
                await asyncio.sleep(0.01)
            await bench.start()
            await listener.until(lambda: listener.images)
            assert listener.gaps == []
        await bench.kill()

    run(test)


def test_check_answers_for_every_variable() -> None:
    async def test() -> None:
        async with OpcUaBench() as bench:
            await bench.put("Station-Step", 4)
            answers = await open_tap(bench.url).check()
            assert [(answer.signal.name, answer.value) for answer in answers] == [
                ("Station-Clamp", 0),
                ("Station-Step", 4),
            ]
        with pytest.raises(InputError, match=r"127\.0\.0\.1"):
            await open_tap(bench.url).check()

    run(test)


def test_a_node_the_server_has_not_is_refused() -> None:
    async def test() -> None:
        async with OpcUaBench() as bench:
            tap = open_tap(f"{bench.url}&browse=ns=2;s=Nowhere")
            with pytest.raises(InputError, match="no node ns=2;s=Nowhere"):
                async for _ in tap:
                    pass
            await tap.close()

    run(test)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ("browse=Station", "not a node id"),
        ("queue=0", "1 to 65535"),
        ("queue=many", "1 to 65535"),
        ("security=Basic128", "security policy"),
        ("security=Basic256Sha256", "certificate=FILE"),
        ("certificate=a.pem", "needs security"),
        ("security=Basic256Sha256&certificate=nowhere.pem&key=k.pem", "no file nowhere.pem"),
        ("timeout=0", "above zero"),
        ("reorder=soon", "not a duration"),
    ],
)
def test_options_that_cannot_work(options: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        open_tap(f"opcua://127.0.0.1:{free_port()}/?{options}")
