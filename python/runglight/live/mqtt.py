"""Findings and the state of watching to an MQTT broker.

`TOPIC/findings`  one finding per message, JSON, QoS 1, not retained
`TOPIC/status`    how watching goes, JSON, QoS 1, retained; the broker itself says `offline` when
                  we vanish (last will)
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
from typing import TYPE_CHECKING
from urllib.parse import unquote, urlsplit

import aiomqtt
import msgspec

from runglight import environment
from runglight.errors import InputError
from runglight.live.delivery import LONGEST_WAIT_NS
from runglight.taps.backoff import Backoff

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from runglight.findings.store import Kept
    from runglight.live.status import Status

PORTS = {"mqtt": 1883, "mqtts": 8883}
OFFLINE = b'{"state":"offline"}'
AT_LEAST_ONCE = 1
STATUS_AT_LEAST_EVERY_S = 60.0


class MqttPublisher:
    """One connection to a broker, opened again when it is lost.

    `status` gives the newest state of watching; it is published when it changes in more than its
    counters, and once a minute.
    """

    at_once = 50
    timeout_s = 10.0
    from_the_start = False

    def __init__(self, url: str, status: Callable[[], Status]) -> None:
        try:
            parts = urlsplit(url)
            port = parts.port
        except ValueError as error:
            raise InputError(f"--publish: {error}; write mqtt://HOST/TOPIC") from None
        self._topic = unquote(parts.path.strip("/"))
        shown = parts._replace(netloc=parts.netloc.rpartition("@")[2]).geturl()
        if parts.scheme not in PORTS or not parts.hostname or not self._topic:
            raise InputError(f"--publish {shown}: write mqtt://HOST[:1883]/TOPIC (mqtts: with TLS)")
        if any(each in self._topic + url for each in "#+\0"):
            raise InputError(f"--publish {shown}: a topic to publish to has no # and no +")
        self.name = shown
        self._host, self._port = parts.hostname, port or PORTS[parts.scheme]
        self._tls = parts.scheme == "mqtts"
        self._username = None if parts.username is None else unquote(parts.username)
        self._password = environment.mqtt_password() or (
            None if parts.password is None else unquote(parts.password)
        )
        self._status = status
        self._client: aiomqtt.Client | None = None
        self._connected = asyncio.Event()
        self._reason = "not connected yet"

    async def run(self) -> None:
        """Holds the connection and publishes the status, until cancelled."""
        backoff = Backoff(longest_ns=LONGEST_WAIT_NS)
        while True:
            try:
                async with self._new_client() as client:
                    self._client = client
                    await self._publish_status(client)
                    backoff.reset()
                    self._connected.set()
                    try:
                        await self._follow_status(client)
                    except asyncio.CancelledError:
                        await self._say_goodbye(client)
                        raise
            except aiomqtt.MqttError as error:
                self._reason = str(error)
            finally:
                self._connected.clear()
                self._client = None
            await asyncio.sleep(backoff.wait_ns() / 1e9)

    async def deliver(self, findings: Sequence[Kept]) -> None:
        """Publishes findings and returns when the broker has confirmed them."""
        try:
            async with asyncio.timeout(2.0):
                await self._connected.wait()
        except TimeoutError:
            raise ConnectionError(self._reason) from None
        client = self._client
        if client is None:
            raise ConnectionError(self._reason)
        topic = f"{self._topic}/findings"
        for kept in findings:
            await client.publish(topic, kept.line.encode(), qos=AT_LEAST_ONCE)

    async def close(self) -> None:
        """Nothing is left to let go of: `run` has said goodbye."""

    async def _say_goodbye(self, client: aiomqtt.Client) -> None:
        # Leaving in order, the last will is not published: nobody shall take us for living.
        with contextlib.suppress(aiomqtt.MqttError, TimeoutError):
            async with asyncio.timeout(1.0):
                await client.publish(
                    f"{self._topic}/status", OFFLINE, qos=AT_LEAST_ONCE, retain=True
                )

    def _new_client(self) -> aiomqtt.Client:
        quiet = logging.getLogger("runglight.mqtt")
        quiet.setLevel(logging.CRITICAL)
        return aiomqtt.Client(
            self._host,
            self._port,
            username=self._username,
            password=self._password,
            tls_params=aiomqtt.TLSParameters() if self._tls else None,
            will=aiomqtt.Will(f"{self._topic}/status", OFFLINE, qos=AT_LEAST_ONCE, retain=True),
            timeout=5.0,
            keepalive=15,
            logger=quiet,
        )

    async def _publish_status(self, client: aiomqtt.Client) -> Status:
        status = self._status()
        await client.publish(
            f"{self._topic}/status",
            msgspec.json.encode(status),
            qos=AT_LEAST_ONCE,
            retain=True,
        )
        return status

    async def _follow_status(self, client: aiomqtt.Client) -> None:
        loop = asyncio.get_running_loop()
        told, told_at_s = self._status(), loop.time()
        while True:
            await asyncio.sleep(0.25)
            due = loop.time() - told_at_s >= STATUS_AT_LEAST_EVERY_S
            if due or not told.is_like(self._status()):
                told, told_at_s = await self._publish_status(client), loop.time()
