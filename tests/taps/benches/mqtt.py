"""A machine that publishes retained values to a broker, which forgets them when it is killed."""

import json

from tests.taps.benches.bench import Bench, free_port
from tests.taps.benches.broker import Broker
from tests.taps.cable import Cable


class MqttBench(Bench):
    polls = False
    changing = "Station-Clamp"

    def __init__(self) -> None:
        self.signals = ["Station-Clamp", "Station-Step"]
        self.broker = Broker()
        # The machine has its say before a tap can connect: the image is whole.
        self.door = Cable(self.broker.port, free_port())
        self.port = self.door.port
        self.keeps = False
        """Whether values outlive a restart."""
        self.values = dict.fromkeys(self.signals, 0)

    @property
    def url(self) -> str:
        return self.url_at(self.port)

    @staticmethod
    def url_at(port: int) -> str:
        return f"mqtt://127.0.0.1:{port}/line/#?timeout=1&keepalive=1"

    @property
    def missing_url(self) -> str:
        return f"mqtt://127.0.0.1:{self.port}/line/#/more"

    @property
    def unreachable_url(self) -> str:
        return self.url_at(free_port())

    async def start(self) -> None:
        if not self.keeps:
            self.values = dict.fromkeys(self.signals, 0)
        await self.broker.start()
        for name, value in self.values.items():
            await self.put(name, value)
        await self.door.open()

    async def kill(self) -> None:
        await self.door.close()
        await self.broker.kill()

    async def change(self, value: int) -> None:
        await self.put(self.changing, value)

    async def put(self, name: str, value: int) -> None:
        self.values[name] = value
        topic = "line/" + name.replace("-", "/")
        await self.broker.publish(topic, json.dumps(value), retain=True)
