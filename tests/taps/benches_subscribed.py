"""Real servers of the protocols that send by themselves: start, change a value, kill, restart."""

import asyncio
import json
import shutil
import subprocess
from abc import ABC, abstractmethod
from pathlib import Path
from typing import Self

import aiomqtt
import pytest
from asyncua import Server, ua

from tests.taps.cable import free_port
from tests.taps.sparkplug_edge import Edge


class Bench(ABC):
    """A server with the boolean `Station-Clamp` and the integer `Station-Step`, both 0."""

    port: int

    @property
    @abstractmethod
    def url(self) -> str:
        """What a tap of it is opened with."""

    @abstractmethod
    async def start(self) -> None:
        """Starts it, or starts it again on the same port."""

    @abstractmethod
    async def kill(self) -> None:
        """Ends it."""

    @abstractmethod
    async def put(self, name: str, value: int) -> None:
        """Changes a value."""

    async def __aenter__(self) -> Self:
        await self.start()
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.kill()


class OpcUaBench(Bench):
    """asyncua's own server, in this process."""

    def __init__(self) -> None:
        self.port = free_port()
        self.server: Server | None = None
        self.values: dict[str, object] = {"Clamp": False, "Step": 0}

    @property
    def url(self) -> str:
        return self.url_at(self.port)

    @staticmethod
    def url_at(port: int) -> str:
        return f"opcua://127.0.0.1:{port}/line?timeout=1"

    async def start(self) -> None:
        server = self.server = Server()
        await server.init()
        server.set_endpoint(f"opc.tcp://127.0.0.1:{self.port}/line")
        self.namespace = await server.register_namespace("urn:runglight:test")
        self.station = await server.nodes.objects.add_object(
            ua.NodeId("Station", self.namespace), f"{self.namespace}:Station"
        )
        self.nodes = {}
        for name, value in self.values.items():
            kind = ua.VariantType.Boolean if isinstance(value, bool) else ua.VariantType.Int16
            self.nodes[name] = await self.station.add_variable(
                ua.NodeId(name, self.namespace), f"{self.namespace}:{name}", value, kind
            )
        await self.more(server)
        await server.start()

    async def more(self, server: Server) -> None:
        """Further nodes."""

    async def kill(self) -> None:
        if self.server is not None:
            server, self.server = self.server, None
            await server.stop()

    async def put(self, name: str, value: int) -> None:
        short = name.removeprefix("Station-")
        content = bool(value) if isinstance(self.values[short], bool) else value
        self.values[short] = content
        kind = ua.VariantType.Boolean if isinstance(content, bool) else ua.VariantType.Int16
        if self.server is not None:
            await self.nodes[short].write_value(content, kind)


class Broker:
    """Debian's mosquitto on a free port of the loopback."""

    def __init__(self, directory: Path, configuration: str = "") -> None:
        self._program = shutil.which("mosquitto") or shutil.which("/usr/sbin/mosquitto")
        if self._program is None:
            pytest.skip("mosquitto is not installed")
        self.port = free_port()
        self._file = directory / "mosquitto.conf"
        self._file.write_text(
            f"listener {self.port} 127.0.0.1\n" + (configuration or "allow_anonymous true\n")
        )
        self._process: subprocess.Popen[bytes] | None = None

    async def start(self) -> None:
        assert self._program is not None
        self._process = subprocess.Popen(
            [self._program, "-c", str(self._file)],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        async with asyncio.timeout(20):
            while True:
                try:
                    _, writer = await asyncio.open_connection("127.0.0.1", self.port)
                except OSError:
                    assert self._process.poll() is None, "mosquitto ended"
                    await asyncio.sleep(0.02)
                else:
                    writer.close()
                    return

    async def kill(self) -> None:
        if self._process is not None:
            process, self._process = self._process, None
            process.kill()
            await asyncio.to_thread(process.wait)

    async def publish(self, topic: str, payload: bytes | str, *, retain: bool = False) -> None:
        async with aiomqtt.Client("127.0.0.1", self.port) as client:
            await client.publish(topic, payload, qos=1, retain=retain)


class MqttBench(Bench):
    """A machine that publishes retained values to a broker without persistence."""

    def __init__(self, directory: Path) -> None:
        self.broker = Broker(directory)
        self.port = self.broker.port
        self.values = {"Station-Clamp": 0, "Station-Step": 0}

    @property
    def url(self) -> str:
        return self.url_at(self.port)

    @staticmethod
    def url_at(port: int) -> str:
        return f"mqtt://127.0.0.1:{port}/line/#?timeout=1&keepalive=1"

    async def start(self) -> None:
        await self.broker.start()
        for name, value in self.values.items():
            await self.put(name, value)

    async def kill(self) -> None:
        await self.broker.kill()

    async def put(self, name: str, value: int) -> None:
        self.values[name] = value
        await self.broker.publish("line/" + name.replace("-", "/"), json.dumps(value), retain=True)


class SparkplugBench(Bench):
    """A broker, and an edge node that answers rebirth requests."""

    def __init__(self, directory: Path) -> None:
        self.broker = Broker(directory)
        self.port = self.broker.port
        self.edge = Edge(self.port)

    @property
    def url(self) -> str:
        return f"sparkplug://127.0.0.1:{self.port}/line?timeout=1&keepalive=1"

    @property
    def node_url(self) -> str:
        """Names the edge node, so that it is asked for its birth at once."""
        return f"sparkplug://127.0.0.1:{self.port}/line/Cell?timeout=1&keepalive=1"

    async def start(self) -> None:
        await self.broker.start()
        await self.edge.start()
        self._running = True

    async def kill(self) -> None:
        self._running = False
        await self.broker.kill()
        await self.edge.stop(death=False)

    async def put(self, name: str, value: int) -> None:
        short = name.removeprefix("Cell-Station-")
        if self._running:
            await self.edge.put(short, value)
        else:
            self.edge.values[short] = value
