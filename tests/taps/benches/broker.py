"""Debian's mosquitto, for the benches that need an MQTT broker."""

import asyncio
import shutil
import subprocess
import tempfile
from pathlib import Path

import aiomqtt
import pytest

from tests.taps.benches.bench import free_port


class Broker:
    """Debian's mosquitto on a free port of the loopback."""

    def __init__(self, configuration: str = "") -> None:
        self._program = shutil.which("mosquitto") or shutil.which("/usr/sbin/mosquitto")
        if self._program is None:
            pytest.skip("mosquitto is not installed")
        self.port = free_port()
        self._configuration = f"listener {self.port} 127.0.0.1\n" + (
            configuration or "allow_anonymous true\n"
        )
        self._process: subprocess.Popen[bytes] | None = None

    async def start(self) -> None:
        assert self._program is not None
        # It is read once, when the broker starts.
        with tempfile.TemporaryDirectory() as directory:
            file = Path(directory) / "mosquitto.conf"
            file.write_text(self._configuration)
            self._process = subprocess.Popen(
                [self._program, "-c", str(file)],
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
            await self._listens()

    async def _listens(self) -> None:
        assert self._process is not None
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
