"""OPC UA: subscriptions to every boolean and integer variable below a node.

`opcua://HOST:4840/PATH?browse=NODE`. Values are subscribed to, never polled, with sampling
interval 0 (as fast as the server can) and a queue per variable, so that changes between two
publishings are not lost. Callbacks are used, not asyncua's iterator, which drops the oldest.
"""

import asyncio
import logging
import struct
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from datetime import UTC, datetime
from typing import Any, ClassVar

from asyncua import ua
from asyncua.client.client import Client
from asyncua.common.node import Node
from asyncua.common.subscription import DataChangeNotif, Subscription
from asyncua.ua import uaerrors

from runglight.errors import InputError
from runglight.taps.base import Answer, TapSignal
from runglight.taps.clock import Clock
from runglight.taps.opcua_browse import Variable, chunks, variables_below
from runglight.taps.opcua_security import REFUSALS, check_security, secure
from runglight.taps.subscription import INT64, SourceLost, SubscribedTap
from runglight.taps.url import SourceUrl

QUEUE = 50
"""Values the server keeps per variable between two publishings."""
PUBLISH_S = 0.01
KEEP_ALIVE_S = 1.0
SESSION_MS = 30_000
OVERFLOW = 0x0480
"""Status bits: the info type is DataValue and the queue ran over (OPC 10000-4, 7.39.1)."""
_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)

# asyncua tells lost connections with tracebacks; ours are told by `Tap.connection`.
if logging.getLogger("asyncua").level == logging.NOTSET:
    logging.getLogger("asyncua").setLevel(logging.CRITICAL + 1)


class OpcUaTap(SubscribedTap):
    """One OPC UA server."""

    losses: ClassVar = (*SubscribedTap.losses, uaerrors.UaError, struct.error, ValueError, KeyError)

    def __init__(self, url: SourceUrl, clock: Clock) -> None:
        super().__init__(url, clock)
        check_security(url)
        written = url.options.get("browse", "i=85")
        try:
            self._root = ua.NodeId.from_string(written)
        except (uaerrors.UaError, ValueError):
            raise InputError(
                f"{url.text}: browse={written} is not a node id; write ns=2;s=NAME or ns=2;i=NUMBER"
            ) from None
        queue = url.options.get("queue", str(QUEUE))
        if not queue.isdecimal() or not 1 <= int(queue) <= 65_535:
            raise InputError(f"{url.text}: queue is {queue!r}; write a number from 1 to 65535")
        self._queue = int(queue)
        self._publish_ms = self.duration("interval", PUBLISH_S) * 1000
        self._image: dict[int, int] | None = None
        self._awaited: set[int] = set()
        self._image_complete = asyncio.Event()
        self._bad_since: dict[int, tuple[int, str]] = {}
        self._ended: asyncio.Future[str] | None = None

    async def check(self) -> list[Answer]:
        """Reads every variable once; InputError where the server cannot be reached."""
        try:
            async with self._client() as client:
                variables = await self._variables(client)
                answers: list[Answer] = []
                for part in chunks(variables):
                    nodes = [client.get_node(variable.node_id) for variable in part]
                    values = await client.read_attributes(nodes)
                    answers += map(_answer, part, values)
                return answers
        except self.losses as error:
            raise InputError(f"{self.url}: {error or 'no answer in time'}") from None

    async def session(self) -> None:
        """Connects, browses, subscribes, and watches over the connection."""
        self._ended = asyncio.get_running_loop().create_future()
        async with self._client() as client:
            client.connection_lost_callback = self._lost
            variables = await self._variables(client)
            indices = {variable.node_id: self.index_of(_signal(variable)) for variable in variables}
            self._image, self._bad_since = {}, {}
            self._awaited = set(indices.values())
            self._image_complete.clear()
            if not indices:
                self._image_complete.set()
            handler = _Handler(self, indices)
            subscription, silence_s = await self._subscription(client, handler)
            for part in chunks(variables):
                nodes = [client.get_node(variable.node_id) for variable in part]
                results: list[int | ua.StatusCode] = await subscription.subscribe_data_change(
                    nodes, queuesize=self._queue, sampling_interval=ua.Duration(0)
                )
                for variable, result in zip(part, results, strict=True):
                    if isinstance(result, ua.StatusCode):
                        self.left_out.add(variable.name, f"cannot be subscribed to: {result.name}")
                        self._arrived(indices[variable.node_id])
            # A variable that sends no first value must not hold up all others.
            with suppress(TimeoutError):
                await asyncio.wait_for(self._image_complete.wait(), self.timeout_s)
            self.arrivals.image(self._image)
            self._image = None
            self.connected()
            subscribed_s = time.monotonic()
            while time.monotonic() - (subscription.last_publish_at or subscribed_s) < silence_s:
                await self._sign_of_life(client)
            raise SourceLost("the server answers, but its subscription has fallen silent")

    def changed(self, index: int, value: ua.DataValue) -> None:
        """The server sent a value of a signal."""
        name = self.signals[index].name
        status = value.StatusCode or ua.StatusCode()
        if status.value & OVERFLOW == OVERFLOW:
            # What the server threw away was not seen, as if the signal had been away.
            reason = f"losing changes on the server, whose queue ran over (queue={self._queue})"
            self.left_out.add(f"queue of {name}", f"ran over, raise queue={self._queue}")
            self._bad_since.setdefault(index, (self._clock.now_ns(), reason))
            self.arrivals.forget([index])
        content = None if value.Value is None else value.Value.Value
        if status.is_bad():
            self._held(index, status.name)
        elif not isinstance(content, int) or int(content) not in INT64:
            self._held(index, "its value is no 64-bit integer")
        else:
            self._good(index, int(content), value.SourceTimestamp or value.ServerTimestamp)
        self._arrived(index)

    async def _subscription(
        self, client: Client, handler: "_Handler"
    ) -> tuple[Subscription, float]:
        """A subscription, and the seconds of silence after which it is dead.

        asyncua's own `create_subscription` hides the publishing interval the server grants, and
        asks for keep-alives minutes apart.
        """
        parameters = ua.CreateSubscriptionParameters()
        parameters.RequestedPublishingInterval = ua.Duration(self._publish_ms)
        keep_alives = max(round(KEEP_ALIVE_S * 1000 / self._publish_ms), 1)
        parameters.RequestedMaxKeepAliveCount = ua.Counter(keep_alives)
        parameters.RequestedLifetimeCount = ua.Counter(keep_alives * 60)
        parameters.MaxNotificationsPerPublish = ua.Counter(10_000)
        parameters.PublishingEnabled = True
        subscription = Subscription(client.uaclient.session, parameters, handler)
        granted = await subscription.init()
        publish_s = granted.RevisedPublishingInterval / 1000
        # Values wait on the server for up to one interval: their order is only known after it.
        self.arrivals.widen(round((publish_s + PUBLISH_S) * 1e9))
        keep_alive_s = publish_s * max(granted.RevisedMaxKeepAliveCount, 1)
        return subscription, 2 * keep_alive_s + self.timeout_s

    def ended(self, reason: str) -> None:
        """The session cannot go on."""
        if self._ended is not None and not self._ended.done():
            self._ended.set_result(reason)

    def _good(self, index: int, value: int, stamp: datetime | None) -> None:
        if self._image is not None:
            self._image[index] = value
            return
        bad = self._bad_since.pop(index, None)
        if bad is not None:
            self.left_out.forget(self.signals[index].name)
            if self.arrivals.values.get(index) != value:
                # What it did meanwhile was not seen: not a change, but a fresh start.
                since_ns, reason = bad
                name = self.signals[index].name
                self.arrivals.resume({index: value}, since_ns, f"{name} was {reason}")
                self.wake()
                return
        self.arrivals.value(index, value, None if stamp is None else _nanoseconds(stamp))
        self.wake()

    def _held(self, index: int, reason: str) -> None:
        """A bad value is no value: the last good one stands, and it is said."""
        self.left_out.add(self.signals[index].name, reason)
        self._bad_since.setdefault(index, (self._clock.now_ns(), reason))
        if self._image is not None:
            self._image.pop(index, None)

    def _arrived(self, index: int) -> None:
        self._awaited.discard(index)
        if not self._awaited:
            self._image_complete.set()

    async def _lost(self, error: Exception) -> None:
        self.ended(str(error) or "the server closed the connection")

    async def _sign_of_life(self, client: Client) -> None:
        """Waits a moment and asks for the state of the server; raises where it is lost."""
        assert self._ended is not None
        done, _ = await asyncio.wait([self._ended], timeout=self.timeout_s / 2)
        if done:
            raise SourceLost(self._ended.result())
        async with asyncio.timeout(self.timeout_s):
            state = await client.nodes.server_state.read_value()
        if state != ua.ServerState.Running:
            raise SourceLost(f"the server is in state {ua.ServerState(state).name}")
        self.arrivals.heard()

    async def _variables(self, client: Client) -> list[Variable]:
        try:
            found = await variables_below(client, self._root)
        except (uaerrors.BadNodeIdUnknown, uaerrors.BadNodeIdInvalid):
            message = f"the server has no node {self._root.to_string()}"
            if self.was_connected:
                # A server that restarts may answer before its program is loaded.
                raise SourceLost(message) from None
            raise InputError(f"{self.url}: {message}; mend browse=") from None
        for variable in found:
            if variable.type is None:
                self.left_out.add(variable.name, variable.reason)
        return [variable for variable in found if variable.type is not None]

    @asynccontextmanager
    async def _client(self) -> AsyncIterator[Client]:
        path = f"/{self._source.path}" if self._source.path else ""
        client = Client(
            f"opc.tcp://{_bracketed(self._source.host)}:{self._source.port}{path}",
            timeout=self.timeout_s,
            watchdog_intervall=self.timeout_s,
        )
        client.name = client.description = "runglight"
        client.session_timeout = SESSION_MS
        try:
            async with asyncio.timeout(self.timeout_s * 3):
                await secure(client, self._source)
                await client.connect()
        except uaerrors.UaStatusCodeError as error:
            if error.code in REFUSALS and not self.was_connected:
                raise InputError(f"{self.url}: the server lets us not in: {error}") from None
            raise
        try:
            yield client
        finally:
            # The server may be gone: letting go of it must not take long, or fail.
            with suppress(Exception):
                async with asyncio.timeout(self.timeout_s):
                    await client.disconnect()
            client.disconnect_socket()


class _Handler:
    """What asyncua calls."""

    def __init__(self, tap: OpcUaTap, indices: dict[ua.NodeId, int]) -> None:
        self._tap = tap
        self._indices = indices

    def datachange_notification(self, node: Node, val: Any, data: DataChangeNotif) -> None:
        index = self._indices.get(node.nodeid)
        if index is not None and data.monitored_item.Value is not None:
            try:
                self._tap.changed(index, data.monitored_item.Value)
            except SourceLost as lost:
                self._tap.ended(str(lost))

    def status_change_notification(self, status: ua.StatusChangeNotification) -> None:
        self._tap.ended(f"the server ended the subscription: {status.Status.name}")


def _signal(variable: Variable) -> TapSignal:
    return TapSignal(
        name=variable.name,
        address=variable.node_id.to_string(),
        type=variable.type or "BOOL",
        signal_class="memory",
    )


def _answer(variable: Variable, value: ua.DataValue) -> Answer:
    status = value.StatusCode or ua.StatusCode()
    content = None if value.Value is None else value.Value.Value
    if status.is_bad() or not isinstance(content, int):
        return Answer(_signal(variable), None, status.name if status.is_bad() else "has no value")
    return Answer(_signal(variable), int(content))


def _nanoseconds(stamp: datetime) -> int:
    """Nanoseconds since 1970; asyncua gives UTC, in older versions without saying so."""
    since = (stamp if stamp.tzinfo is not None else stamp.replace(tzinfo=UTC)) - _EPOCH
    return (since.days * 86_400 + since.seconds) * 1_000_000_000 + since.microseconds * 1000


def _bracketed(host: str) -> str:
    return f"[{host}]" if ":" in host else host
