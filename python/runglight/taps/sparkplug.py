"""Sparkplug B: `sparkplug://HOST:1883/GROUP` (all groups where none is named).

Births name metrics, their types and aliases; data messages carry changes; deaths and missing
sequence numbers mean that something was not seen, which is a gap until the next birth. A birth that
is missing is asked for: the command `Node Control/Rebirth` is the only thing ever published, to the
edge node and never to the PLC, and `rebirth=no` forbids even that. A tap claims no STATE: it is no
host application that edge nodes would wait for.
"""

from typing import ClassVar

import aiomqtt

from runglight.errors import InputError
from runglight.taps.base import Answer, TapSignal
from runglight.taps.broker import QOS, BrokerOptions, Inbox, payload_bytes
from runglight.taps.clock import Clock
from runglight.taps.sparkplug_node import NODE, Born, EdgeNode
from runglight.taps.sparkplug_payload import (
    IEC_TYPES,
    OTHER_TYPES,
    DataType,
    Metric,
    Payload,
    PayloadError,
    decode_payload,
    rebirth_request,
)
from runglight.taps.subscription import SourceLost, SubscribedTap
from runglight.taps.url import SourceUrl

NAMESPACE = "spBv1.0"
NODE_KINDS = ("NBIRTH", "NDATA", "NDEATH")
DEVICE_KINDS = ("DBIRTH", "DDATA", "DDEATH")
BURST_S = 0.2
"""Births of a node and its devices come in one burst; this silence ends it."""
ASK_AGAIN_NS = 5_000_000_000
"""A node that does not answer is not asked more often than this."""
_CONTROL = ("Node Control/", "Device Control/")


class SparkplugTap(SubscribedTap):
    """The edge nodes of one group (or of one node: `GROUP/NODE`)."""

    losses: ClassVar = (*SubscribedTap.losses, aiomqtt.MqttError)

    def __init__(self, url: SourceUrl, clock: Clock) -> None:
        super().__init__(url, clock)
        levels = url.path.rstrip("/#").split("/") if url.path.rstrip("/#") else []
        if len(levels) > 2 or any(set(level) & set("+#") for level in levels):
            raise InputError(
                f"{url.text}: {url.path} is no group; write sparkplug://HOST/GROUP or "
                "sparkplug://HOST/GROUP/NODE"
            )
        self._group, self._node = (*levels, "+", "+")[:2]
        self._may_ask = self.switch("rebirth", True)
        self._broker = BrokerOptions(self, url)
        self._nodes: dict[tuple[str, str], EdgeNode] = {}
        self._to_ask: list[EdgeNode] = []
        self._image: dict[int, int] | None = None
        self._last_birth_ns = 0
        self._returned: dict[int, int] = {}
        self._returned_since_ns: int | None = None
        self._returned_reason = ""

    async def check(self) -> list[Answer]:
        """Reads what the births tell; InputError where the broker cannot be reached."""
        try:
            async with self._broker.client(was_connected=False) as client:
                inbox = Inbox(client)
                await self._subscribe(client)
                values = await self._first_births(client, inbox)
                inbox.close()
        except self.losses as error:
            raise InputError(f"{self.url}: {error or 'no answer in time'}") from None
        return [
            Answer(signal, values.get(index), None if index in values else "has no value")
            for index, signal in enumerate(self.signals)
        ]

    async def session(self) -> None:
        """Subscribes and receives until the broker is lost."""
        async with self._broker.client(was_connected=self.was_connected) as client:
            inbox = Inbox(client)
            try:
                await self._subscribe(client)
                self.arrivals.image(await self._first_births(client, inbox))
                self.connected()
                while True:
                    waiting = self._returned_since_ns is not None
                    message = await inbox.next(BURST_S if waiting else None)
                    if message is None:
                        self._resume()
                    else:
                        self._take(message)
                    self.wake()
                    await self._ask(client)
            finally:
                inbox.close()

    async def _subscribe(self, client: aiomqtt.Client) -> None:
        topics = [
            *(f"{NAMESPACE}/{self._group}/{kind}/{self._node}" for kind in NODE_KINDS),
            *(f"{NAMESPACE}/{self._group}/{kind}/{self._node}/+" for kind in DEVICE_KINDS),
        ]
        for granted in await client.subscribe([(topic, QOS) for topic in topics]):
            if getattr(granted, "is_failure", False):
                message = f"the broker refuses a subscription to {NAMESPACE}/{self._group}"
                if self.was_connected:
                    raise SourceLost(message)
                raise InputError(f"{self.url}: {message}: {granted}")

    async def _first_births(self, client: aiomqtt.Client, inbox: Inbox) -> dict[int, int]:
        """Asks every known node for its birth, and waits a while for those that answer."""
        image = self._image = {}
        self._returned_since_ns = None
        self._returned.clear()
        if self._node != "+" and self._group != "+":
            self._edge_node(self._group, self._node)
        for node in self._nodes.values():
            node.death(NODE, self._clock.now_ns())
            node.unseen_since_ns.clear()
            node.asked_ns = None
            self._to_ask.append(node)
        await self._ask(client)
        deadline_ns = self._clock.now_ns() + round(self.timeout_s * 1e9)
        while True:
            due_ns = deadline_ns
            if self._nodes and all(node.born for node in self._nodes.values()):
                due_ns = min(due_ns, self._last_birth_ns + round(BURST_S * 1e9))
            left_s = (due_ns - self._clock.now_ns()) / 1e9
            message = await inbox.next(left_s) if left_s > 0 else None
            if message is None:
                break
            self._take(message)
            await self._ask(client)
        self._image = None
        return image

    def _take(self, message: aiomqtt.Message) -> None:
        """One message of an edge node or a device."""
        topic = str(message.topic)
        _, group, kind, name, *rest = topic.split("/", 4)
        node, device = self._edge_node(group, name), (rest[0] if rest else NODE)
        self.arrivals.heard()
        try:
            payload = decode_payload(payload_bytes(message))
        except PayloadError as error:
            self.left_out.add(topic, str(error))
            return
        if message.retain:
            # Retained births are of an unknown age; the specification forbids them.
            self.left_out.add(topic, "is retained, and so perhaps long past")
            self._wish_birth(node)
        elif kind.endswith("BIRTH"):
            self._birth(node, device, payload)
        elif kind.endswith("DATA"):
            self._data(node, device, payload)
        elif device == NODE:
            bd_seq = payload.bd_seq()
            if node.born and (bd_seq is None or node.bd_seq is None or bd_seq == node.bd_seq):
                self._death(node, NODE)
        else:
            self._in_sequence(node, payload)
            self._death(node, device)

    def _birth(self, node: EdgeNode, device: str, payload: Payload) -> None:
        if device == NODE:
            if node.born and payload.bd_seq() != node.bd_seq:
                # It was born anew, and we missed its death.
                self._doubt(node, NODE)
        elif not node.born:
            self._wish_birth(node)
            return
        else:
            self._in_sequence(node, payload)
        node.birth(device, payload)
        self._last_birth_ns = self._clock.now_ns()
        since_ns = node.unseen_since_ns.pop(device, None)
        for metric in payload.metrics:
            if metric.name is None or metric.name == "bdSeq" or metric.name.startswith(_CONTROL):
                continue
            born = Born(device, metric.name, metric.datatype or 0)
            if born.datatype not in IEC_TYPES:
                what = OTHER_TYPES.get(born.datatype, "an array or a set of properties")
                self.left_out.add(_name(node, born), f"is {what}, neither boolean nor integer")
                continue
            index = self.index_of(_signal(node, born))
            value = self._value(node, born, metric)
            if value is None:
                continue
            if self._image is not None:
                self._image[index] = value
            elif since_ns is not None:
                self._returned[index] = value
            elif self.arrivals.values.get(index) != value:
                self._put(node, index, value, metric, payload)
        if since_ns is not None and self._image is None:
            self._returned_since_ns = min(since_ns, self._returned_since_ns or since_ns)
            self._returned_reason = f"{_called(node, device)} was not seen until its birth"

    def _data(self, node: EdgeNode, device: str, payload: Payload) -> None:
        if not node.born:
            self._wish_birth(node)
            return
        self._in_sequence(node, payload)
        self._resume()
        for metric in payload.metrics:
            born = node.find(device, metric)
            if born is None:
                self.left_out.add(_called(node, device), "sent a metric its birth does not name")
                self._wish_birth(node)
            elif metric.historical:
                name = _name(node, born)
                self.left_out.add(f"history of {name}", "is not of now, and came too late to be")
            elif born.datatype in IEC_TYPES and not born.name.startswith(_CONTROL):
                value = self._value(node, born, metric)
                if value is not None:
                    index = self.index_of(_signal(node, born))
                    self._put(node, index, value, metric, payload)

    def _put(
        self, node: EdgeNode, index: int, value: int, metric: Metric, payload: Payload
    ) -> None:
        if self._image is not None:
            self._image[index] = value
            return
        stamp_ms = metric.timestamp_ms or payload.timestamp_ms
        stamp_ns = None if stamp_ms is None else stamp_ms * 1_000_000
        self.arrivals.value(index, value, stamp_ns, f"{node.group}/{node.name}")

    def _value(self, node: EdgeNode, born: Born, metric: Metric) -> int | None:
        """The value; where there is none the signal is held, and that is said."""
        value = metric.value(born.datatype)
        if value is None:
            reason = "is null" if metric.null or metric.raw is None else "is no 64-bit integer"
            self.left_out.add(_name(node, born), reason)
        return value

    def _death(self, node: EdgeNode, device: str) -> None:
        self._forget(node, node.death(device, self._clock.now_ns()))

    def _in_sequence(self, node: EdgeNode, payload: Payload) -> None:
        """A missing message may have held any change: what the node said last is in doubt."""
        if node.in_sequence(payload.seq):
            return
        self.left_out.add(f"{node.group}/{node.name}", "messages were lost on the way")
        self._doubt(node, NODE)
        self._wish_birth(node)
        if self._image is None and not self._may_ask:
            # Nobody will tell what was missed: go on from here.
            self._returned_since_ns = self._clock.now_ns()
            self._returned_reason = f"messages of {_called(node, NODE)} were lost"
            node.unseen_since_ns.clear()

    def _doubt(self, node: EdgeNode, device: str) -> None:
        self._forget(node, node.unseen(device, self._clock.now_ns()))

    def _forget(self, node: EdgeNode, devices: set[str]) -> None:
        prefixes = {f"{node.group}/{node.name}/{device}:" for device in devices}
        concerned = [
            index
            for index, signal in enumerate(self.signals)
            if signal.address[: signal.address.index(":") + 1] in prefixes
        ]
        self.arrivals.forget(concerned)
        for index in concerned:
            self._returned.pop(index, None)
            if self._image is not None:
                self._image.pop(index, None)

    def _resume(self) -> None:
        """Devices that were not seen are back: a gap, and then everything as it stands."""
        if self._returned_since_ns is not None:
            self.arrivals.resume(self._returned, self._returned_since_ns, self._returned_reason)
            self._returned_since_ns = None
            self._returned.clear()

    def _edge_node(self, group: str, name: str) -> EdgeNode:
        return self._nodes.setdefault((group, name), EdgeNode(group, name))

    def _wish_birth(self, node: EdgeNode) -> None:
        if node not in self._to_ask:
            self._to_ask.append(node)

    async def _ask(self, client: aiomqtt.Client) -> None:
        nodes, self._to_ask = self._to_ask, []
        now_ns = self._clock.now_ns()
        for node in nodes:
            recently = node.asked_ns is not None and now_ns - node.asked_ns < ASK_AGAIN_NS
            if not self._may_ask or recently:
                continue
            node.asked_ns = now_ns
            await client.publish(
                f"{NAMESPACE}/{node.group}/NCMD/{node.name}",
                rebirth_request(now_ns // 1_000_000),
            )


def _signal(node: EdgeNode, born: Born) -> TapSignal:
    return TapSignal(
        name=_name(node, born),
        address=f"{node.group}/{node.name}/{born.device}:{born.name}",
        type=IEC_TYPES[DataType(born.datatype)],
        signal_class="memory",
    )


def _name(node: EdgeNode, born: Born) -> str:
    return "-".join(filter(None, (node.name, born.device, *born.name.split("/"))))


def _called(node: EdgeNode, device: str) -> str:
    return f"device {node.name}/{device}" if device else f"edge node {node.name}"
