"""The MQTT tap with a real broker."""

import asyncio
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from runglight.errors import InputError
from runglight.taps import open_tap
from runglight.taps.base import ConnectionState
from tests.taps.benches.bench import free_port
from tests.taps.benches.broker import Broker
from tests.taps.benches.mqtt import MqttBench
from tests.taps.cable import Cable
from tests.taps.listening import HANG_S, Listener, check_order


def run(test: Callable[[], object]) -> None:
    asyncio.run(test())  # type: ignore[arg-type]


async def retrying(listener: Listener) -> None:
    async with asyncio.timeout(HANG_S):
        while listener.tap.connection.state is not ConnectionState.RETRYING:
            await asyncio.sleep(0.01)


def test_retained_messages_make_the_image_and_signals_appear_as_they_are_seen() -> None:
    async def test() -> None:
        async with MqttBench() as bench, Listener(open_tap(bench.url)) as listener:
            await listener.until(lambda: listener.images)
            assert listener.images[0] == {"Station-Clamp": 0, "Station-Step": 0}
            await bench.broker.publish("line/Robot", '{"Gripper": true, "Job": 12, "Load": 1.5}')
            await listener.until(lambda: listener.changes("Robot-Job"))
            assert listener.changes("Robot-Gripper") == [1]
            assert listener.changes("Robot-Job") == [12]
            signals = {signal.name: signal for signal in listener.tap.signals}
            assert signals["Robot-Job"].address == "line/Robot#Job"
            assert signals["Station-Step"].address == "line/Station/Step"
            assert any(line.startswith("Robot-Load: ") for line in listener.tap.notices)
            check_order(listener.batches)

    run(test)


def test_a_burst_arrives_complete_and_in_order() -> None:
    async def test() -> None:
        async with MqttBench() as bench, Listener(open_tap(bench.url)) as listener:
            await listener.until(lambda: listener.images)
            import aiomqtt  # noqa: PLC0415

            async with aiomqtt.Client("127.0.0.1", bench.port) as client:
                for step in range(500):
                    await client.publish("line/Station/Step", str(step))
            await listener.until(lambda: 499 in listener.changes("Station-Step"))
            assert listener.changes("Station-Step") == list(range(500))
            check_order(listener.batches)

    run(test)


def test_times_of_the_messages_are_taken() -> None:
    async def test() -> None:
        async with (
            MqttBench() as bench,
            Listener(open_tap(bench.url + "&reorder=5s")) as listener,
        ):
            await listener.until(lambda: listener.images)
            # The first stamp opens the window; what was handed on before it is the edge.
            await bench.broker.publish(
                "line/Station/Step", f'{{"value": 1, "time": {time.time_ns()}}}'
            )
            await asyncio.sleep(0.3)
            stamp_ns = time.time_ns()
            for name, value, earlier_ms in (("Step", 2, 0), ("Clamp", 1, 120)):
                stamp = stamp_ns - earlier_ms * 1_000_000
                await bench.broker.publish(
                    f"line/Station/{name}", f'{{"value": {value}, "timestamp": {stamp}}}'
                )
            await listener.until(lambda: 2 in listener.changes("Station-Step"))
            assert listener.times("Station-Step")[-1] == stamp_ns
            assert listener.times("Station-Clamp") == [stamp_ns - 120_000_000]
            check_order(listener.batches)

    run(test)


def test_a_killed_broker_is_a_gap_and_the_next_image_follows() -> None:
    async def test() -> None:
        async with MqttBench() as bench, Listener(open_tap(bench.url)) as listener:
            await listener.until(lambda: listener.images)
            await bench.put("Station-Step", 1)
            await listener.until(lambda: listener.changes("Station-Step") == [1])
            bench.keeps = True
            await bench.kill()
            await retrying(listener)
            assert listener.tap.connection.reason
            bench.values["Station-Step"] = 2
            await bench.start()
            await listener.until(lambda: len(listener.images) == 2)
            [gap] = listener.gaps
            assert listener.times("Station-Step")[0] <= gap.start_ns < gap.end_ns
            assert listener.tap.connection.reconnects == 1
            assert listener.images[1] == {"Station-Clamp": 0, "Station-Step": 2}
            assert listener.changes("Station-Step") == [1]
            check_order(listener.batches)

    run(test)


def test_a_cut_cable_is_noticed_by_the_keepalive() -> None:
    async def test() -> None:
        async with (
            MqttBench() as bench,
            Cable(bench.port) as cable,
            Listener(open_tap(bench.url_at(cable.port))) as listener,
        ):
            await listener.until(lambda: listener.images)
            cable.cut()
            await retrying(listener)
            await bench.put("Station-Step", 9)
            cable.mend()
            await listener.until(lambda: len(listener.images) == 2)
            assert listener.images[1]["Station-Step"] == 9
            assert len(listener.gaps) == 1
            check_order(listener.batches)

    run(test)


def test_one_topic_without_a_wildcard() -> None:
    async def test() -> None:
        async with MqttBench() as bench:
            url = f"mqtt://127.0.0.1:{bench.port}/line/Station/Step"
            async with Listener(open_tap(url)) as listener:
                await listener.until(lambda: listener.images)
                assert listener.images == [{"Step": 0}]

    run(test)


def test_check_tells_what_is_retained() -> None:
    async def test() -> None:
        async with MqttBench() as bench:
            await bench.broker.publish("line/Recipe", "A7", retain=True)
            answers = await open_tap(bench.url).check()
            found = {answer.signal.name: (answer.value, answer.error) for answer in answers}
            assert found == {
                "Station-Clamp": (0, None),
                "Station-Step": (0, None),
                "Recipe": (None, "is text, neither boolean nor integer"),
            }
        with pytest.raises(InputError, match=r"127\.0\.0\.1"):
            await open_tap(bench.url).check()

    run(test)


def test_user_and_password(tmp_path: Path) -> None:
    passwords = tmp_path / "passwords"
    made = subprocess.run(
        ["mosquitto_passwd", "-b", "-c", str(passwords), "tapper", "se:cret#1"],
        check=False,
        capture_output=True,
    )
    if made.returncode:
        pytest.skip("mosquitto_passwd cannot be run")
    passwords.chmod(0o644)
    tmp_path.chmod(0o755)

    async def test() -> None:
        broker = Broker(f"allow_anonymous false\npassword_file {passwords}\nuser root\n")
        await broker.start()
        try:
            url = f"mqtt://tapper:se%3Acret%231@127.0.0.1:{broker.port}/line/#"
            tap = open_tap(url)
            assert "cret" not in tap.url
            async with Listener(tap) as listener:
                await listener.until(lambda: listener.images)
            async with open_tap(f"mqtt://127.0.0.1:{broker.port}/line/#") as stranger:
                with pytest.raises(InputError, match="lets us not in"):
                    async for _ in stranger:
                        pass
        finally:
            await broker.kill()

    run(test)


def certificate(directory: Path) -> tuple[Path, Path]:
    """A certificate of 127.0.0.1, signed by itself, and its key."""
    files = directory / "server.pem", directory / "server.key"
    subprocess.run(
        ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1",
         "-nodes", "-days", "2", "-subj", "/CN=127.0.0.1", "-addext",
         "subjectAltName=IP:127.0.0.1", "-out", files[0], "-keyout", files[1]],
        check=True,
        capture_output=True,
    )  # fmt: skip
    files[1].chmod(0o644)
    return files


# paho leaves a socket whose handshake fails to the garbage collector.
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_tls_with_a_certificate_of_ones_own(tmp_path: Path) -> None:
    pem, key = certificate(tmp_path)

    async def test() -> None:
        broker = Broker(f"allow_anonymous true\ncertfile {pem}\nkeyfile {key}\nuser root\n")
        await broker.start()
        try:
            url = f"mqtt://127.0.0.1:{broker.port}/line/#?timeout=2"
            async with Listener(open_tap(f"{url}&ca={pem}")) as listener:
                await listener.until(lambda: listener.images)
            # Without the certificate the broker is not believed.
            async with Listener(open_tap(f"{url}&tls=yes")) as listener:
                await retrying(listener)
                assert "certificate" in (listener.tap.connection.reason or "").lower()
        finally:
            await broker.kill()

    run(test)


@pytest.mark.parametrize(
    ("rest", "said"),
    [
        ("line/#/more", "no topic filter"),
        ("line/a+", "no topic filter"),
        ("line/#?ca=nowhere.pem", "no file nowhere.pem"),
        ("line/#?tls=perhaps", "yes or no"),
        ("line/#?qos=1", "unknown option"),
    ],
)
def test_what_cannot_work(rest: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        open_tap(f"mqtt://127.0.0.1:{free_port()}/{rest}")
