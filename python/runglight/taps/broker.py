"""The connection to an MQTT broker, for the taps that read from one."""

import asyncio
import logging
import socket
import ssl
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from pathlib import Path
from uuid import uuid4

import aiomqtt

from runglight.errors import InputError
from runglight.taps.subscription import SubscribedTap
from runglight.taps.url import SourceUrl

KEEPALIVE_S = 5.0
"""Without a word for one and a half of this, the connection counts as lost."""
TLS_PORT = 8883
QOS = 0
"""Acknowledging every message is slower by six times, and a broker throws away what waits too long;
on one TCP connection nothing else is lost, and a lost connection is a gap in any case."""
_NOT_LET_IN = ("bad user name or password", "not authorized", "identifier rejected", "banned")

# aiomqtt logs what it also raises.
_LOGGER = logging.getLogger("runglight.taps.mqtt")
_LOGGER.addHandler(logging.NullHandler())
_LOGGER.propagate = False


class BrokerOptions:
    """How to reach a broker, from the options of a URL; InputError for what cannot work."""

    def __init__(self, tap: SubscribedTap, url: SourceUrl) -> None:
        self._url = url
        self._keepalive_s = max(round(tap.duration("keepalive", KEEPALIVE_S)), 1)
        self._tls = tap.switch("tls", "ca" in url.options)
        ca = url.options.get("ca")
        if ca is not None and not Path(ca).is_file():
            raise InputError(f"{url.text}: ca: there is no file {ca}")
        if ca is not None and not self._tls:
            raise InputError(f"{url.text}: ca needs tls=yes")
        self._ca = ca
        authority = url.text.partition("//")[2].partition("/")[0].partition("?")[0]
        named_port = authority.endswith(f":{url.port}")
        self._port = TLS_PORT if self._tls and not named_port else url.port
        # A client that takes another one's name throws it out of the broker.
        self._identifier = url.options.get("client") or f"runglight-{uuid4().hex[:12]}"
        self._timeout_s = tap.timeout_s

    @asynccontextmanager
    async def client(self, *, was_connected: bool) -> AsyncIterator[aiomqtt.Client]:
        """A connected client; InputError where the broker never lets us in."""
        client = aiomqtt.Client(
            self._url.host,
            self._port,
            username=self._url.username,
            password=self._url.password,
            identifier=self._identifier,
            keepalive=self._keepalive_s,
            timeout=self._timeout_s,
            tls_context=await self._context(),
            logger=_LOGGER,
            # Small packets, such as keep-alives and rebirth requests, are not to wait for company.
            socket_options=[(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)],
        )
        try:
            # Connecting blocks a thread for as long as the system likes.
            async with asyncio.timeout(self._timeout_s * 3):
                await client.__aenter__()
        except aiomqtt.MqttError as error:
            if not was_connected and any(text in str(error).lower() for text in _NOT_LET_IN):
                raise InputError(
                    f"{self._url.text}: the broker lets us not in: {error}; "
                    "give mqtt://USER:PASSWORD@HOST"
                ) from None
            raise
        try:
            yield client
        finally:
            # The broker may be gone: what it says to our farewell does not matter.
            with suppress(aiomqtt.MqttError):
                await client.__aexit__(None, None, None)

    async def _context(self) -> ssl.SSLContext | None:
        if not self._tls:
            return None
        try:
            return await asyncio.to_thread(ssl.create_default_context, cafile=self._ca)
        except ssl.SSLError:
            raise InputError(
                f"{self._url.text}: ca: {self._ca} holds no certificate in PEM form"
            ) from None


class Inbox:
    """The messages of a client, one by one, with a limit on the wait.

    A wait that ends does not cancel the receiving: a message that comes in that very moment would
    be lost with it.
    """

    def __init__(self, client: aiomqtt.Client) -> None:
        self._messages = client.messages
        self._coming: asyncio.Task[aiomqtt.Message] | None = None

    async def next(self, within_s: float | None = None) -> aiomqtt.Message | None:
        """The next message; None where none comes in time. Raises MqttError when disconnected."""
        if self._coming is None:
            self._coming = asyncio.ensure_future(self._receive())
        done, _ = await asyncio.wait([self._coming], timeout=within_s)
        if not done:
            return None
        coming, self._coming = self._coming, None
        return coming.result()

    async def _receive(self) -> aiomqtt.Message:
        return await anext(self._messages)

    def close(self) -> None:
        """Stops receiving."""
        if self._coming is not None:
            self._coming.cancel()


def payload_bytes(message: aiomqtt.Message) -> bytes:
    """The payload of a received message, which is always bytes."""
    payload = message.payload
    return payload if isinstance(payload, bytes) else str(payload or "").encode()
