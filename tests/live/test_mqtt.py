"""Findings and status through a real broker."""

import asyncio
import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import aiomqtt
import pytest

from runglight.errors import InputError
from runglight.live.mqtt import MqttPublisher
from runglight.log.changelog import Log
from runglight.model import NominalModel
from tests.live.broker import Broker
from tests.live.double_tap import batch_of
from tests.live.running import GUARD_S, Watching, until


@pytest.fixture
def broker(tmp_path: Path) -> Iterator[Broker]:
    broker = Broker(tmp_path)
    broker.start()
    yield broker
    broker.stop()


class Listener:
    """A subscriber that keeps what it hears, and listens again when the broker is back."""

    def __init__(self, broker: Broker) -> None:
        self._port = broker.port
        self.findings: list[str] = []
        self.statuses: list[dict[str, object]] = []
        self.listening = asyncio.Event()

    async def run(self) -> None:
        while True:
            try:
                async with aiomqtt.Client("127.0.0.1", self._port) as client:
                    await client.subscribe("plant/cell/#", qos=1)
                    self.listening.set()
                    async for message in client.messages:
                        text = bytes(message.payload).decode()  # type: ignore[arg-type]
                        if message.topic.matches("plant/cell/findings"):
                            self.findings.append(text)
                        else:
                            self.statuses.append(json.loads(text))
            except aiomqtt.MqttError:
                self.listening.clear()
                await asyncio.sleep(0.05)


def test_findings_and_status(
    broker: Broker,
    nominal_model: NominalModel,
    model_directory: Path,
    faulty: Log,
    offline: list[str],
) -> None:
    async def main() -> None:
        listener = Listener(broker)
        listening = asyncio.create_task(listener.run())
        async with asyncio.timeout(GUARD_S):
            await listener.listening.wait()
        watching = Watching(nominal_model, model_directory, faulty)
        publisher = MqttPublisher(
            f"mqtt://127.0.0.1:{broker.port}/plant/cell", watching.session.status
        )
        run = asyncio.create_task(watching.session.run([publisher]))
        watching.tap.feed(batch_of(faulty, 0, len(faulty)))
        await until(lambda: listener.findings == offline)
        # Retained, so that whoever comes later knows how watching goes.
        await until(lambda: any(each.get("changes") == len(faulty) for each in listener.statuses))
        assert listener.statuses[-1]["state"] == "connected"
        late = Listener(broker)
        late_listening = asyncio.create_task(late.run())
        await until(lambda: bool(late.statuses))
        assert not late.findings
        watching.session.stop()
        await run
        await until(lambda: listener.statuses[-1] == {"state": "offline"})
        assert not watching.said
        for task in (listening, late_listening):
            task.cancel()
        await asyncio.gather(listening, late_listening, return_exceptions=True)

    asyncio.run(main())


def test_a_broker_that_comes_back_is_given_what_it_missed(
    broker: Broker,
    nominal_model: NominalModel,
    model_directory: Path,
    faulty: Log,
    offline: list[str],
) -> None:
    async def main() -> None:
        broker.stop()
        watching = Watching(nominal_model, model_directory, faulty)
        publisher = MqttPublisher(
            f"mqtt://127.0.0.1:{broker.port}/plant/cell", watching.session.status
        )
        publisher.timeout_s = 0.5
        run = asyncio.create_task(watching.session.run([publisher]))
        watching.tap.feed(batch_of(faulty, 0, len(faulty)))
        await until(lambda: watching.told == offline)
        await until(lambda: any("takes no findings" in each for each in watching.said))
        broker.start()
        listener = Listener(broker)
        listening = asyncio.create_task(listener.run())
        # In order and whole; at least once, as QoS 1 says.
        await until(lambda: list(dict.fromkeys(listener.findings)) == offline)
        watching.session.stop()
        await run
        listening.cancel()
        await asyncio.gather(listening, return_exceptions=True)

    # A listener that came after the broker and before the delivery hears it all.
    asyncio.run(main())


VANISHING = """
import asyncio, os, sys
from runglight.live.mqtt import MqttPublisher
from runglight.live.status import Progress
from runglight.taps.base import Connection

async def main():
    progress = Progress("double://tap")
    publisher = MqttPublisher(sys.argv[1], lambda: progress.status(Connection()))
    running = asyncio.create_task(publisher.run())
    await publisher._connected.wait()
    os._exit(1)

asyncio.run(main())
"""


def test_the_broker_says_that_we_vanished(broker: Broker) -> None:
    async def main() -> None:
        listener = Listener(broker)
        listening = asyncio.create_task(listener.run())
        async with asyncio.timeout(GUARD_S):
            await listener.listening.wait()
        url = f"mqtt://127.0.0.1:{broker.port}/plant/cell"
        command = [sys.executable, "-c", VANISHING, url]
        await asyncio.to_thread(subprocess.run, command, timeout=GUARD_S, check=False)
        await until(lambda: {"state": "offline"} in listener.statuses)
        assert listener.statuses[0]["state"] == "connecting"
        listening.cancel()
        await asyncio.gather(listening, return_exceptions=True)

    asyncio.run(main())


@pytest.mark.parametrize(
    "url", ["mqtt://host", "mqtt://host/", "mqtt:///topic", "http://host/t", "mqtt://host/a/#"]
)
def test_what_is_no_address_is_refused(url: str) -> None:
    with pytest.raises(InputError, match="--publish"):
        MqttPublisher(url, lambda: pytest.fail("nobody asked"))


def test_a_password_is_not_shown() -> None:
    publisher = MqttPublisher("mqtt://me:secret@host/topic", lambda: pytest.fail("nobody asked"))
    assert publisher.name == "mqtt://host/topic"
