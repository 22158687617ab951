"""Plain MQTT topics: `mqtt://HOST:1883/TOPIC/#`.

A topic is a signal, or several where its message is a flat JSON object. Signals appear as they are
seen. Retained messages, which the broker sends first, make the image; what is not retained is known
from its first message on.
"""

from typing import ClassVar

import aiomqtt

from runglight.errors import InputError
from runglight.taps.base import Answer, TapSignal
from runglight.taps.broker import QOS, BrokerOptions, Inbox, payload_bytes
from runglight.taps.clock import Clock
from runglight.taps.mqtt_payload import Member, read_payload
from runglight.taps.subscription import SourceLost, SubscribedTap
from runglight.taps.url import SourceUrl

RETAINED_S = 0.2
"""The broker does not say which retained message is the last: this silence ends them."""


class MqttTap(SubscribedTap):
    """One topic filter of one broker."""

    losses: ClassVar = (*SubscribedTap.losses, aiomqtt.MqttError)
    stamped: ClassVar = False

    def __init__(self, url: SourceUrl, clock: Clock) -> None:
        super().__init__(url, clock)
        self._filter = url.path or "#"
        check_filter(url, self._filter)
        self._fixed = fixed_part(self._filter)
        self._broker = BrokerOptions(self, url)

    async def check(self) -> list[Answer]:
        """What is retained, as the broker sends it; InputError where it cannot be reached."""
        try:
            async with self._broker.client(was_connected=False) as client:
                await self._subscribe(client)
                inbox = Inbox(client)
                retained, _ = await self._retained(inbox)
                inbox.close()
        except self.losses as error:
            raise InputError(f"{self.url}: {error or 'no answer in time'}") from None
        return [
            Answer(self._signal(topic, member), member.value, member.reason or None)
            for topic, member in retained
        ]

    async def session(self) -> None:
        """Subscribes and receives until the broker is lost."""
        async with self._broker.client(was_connected=self.was_connected) as client:
            inbox = Inbox(client)
            try:
                await self._subscribe(client)
                retained, message = await self._retained(inbox)
                image: dict[int, int] = {}
                for topic, member in retained:
                    if member.value is not None:
                        image[self.index_of(self._signal(topic, member))] = member.value
                    else:
                        self._leave_out(topic, member)
                self.arrivals.image(image)
                self.connected()
                while True:
                    if message is not None:
                        self._take(message)
                    message = await inbox.next()
            finally:
                inbox.close()

    async def _subscribe(self, client: aiomqtt.Client) -> None:
        for granted in await client.subscribe(self._filter, qos=QOS):
            if getattr(granted, "is_failure", False):
                message = f"the broker refuses {self._filter}: {granted}"
                if self.was_connected:
                    raise SourceLost(message)
                raise InputError(f"{self.url}: {message}")

    async def _retained(
        self, inbox: Inbox
    ) -> tuple[list[tuple[str, Member]], aiomqtt.Message | None]:
        """Members of the retained messages, and the first message that is not retained."""
        members: list[tuple[str, Member]] = []
        while (message := await inbox.next(RETAINED_S)) is not None and message.retain:
            topic = str(message.topic)
            members += [(topic, member) for member in read_payload(payload_bytes(message))]
        # The broker sends them in no order of note; indices should not change from run to run.
        members.sort(key=lambda retained: retained[0])
        return members, message

    def _take(self, message: aiomqtt.Message) -> None:
        topic = str(message.topic)
        for member in read_payload(payload_bytes(message)):
            if member.value is None:
                self.arrivals.heard()
                self._leave_out(topic, member)
            else:
                index = self.index_of(self._signal(topic, member))
                self.arrivals.value(index, member.value, member.stamp_ns)
        self.wake()

    def _leave_out(self, topic: str, member: Member) -> None:
        self.left_out.add(self._name(topic, member), member.reason)

    def _signal(self, topic: str, member: Member) -> TapSignal:
        address = f"{topic}#{member.name}" if member.name else topic
        return TapSignal(
            name=self._name(topic, member),
            address=address,
            type=member.type,
            signal_class="memory",
        )

    def _name(self, topic: str, member: Member) -> str:
        """The topic below the fixed part of the filter; the last level where nothing is below."""
        if f"{topic}/" == self._fixed:
            below = topic.rpartition("/")[2]
        else:
            below = topic.removeprefix(self._fixed)
        return "-".join(filter(None, (*below.split("/"), member.name)))


def check_filter(url: SourceUrl, topic_filter: str) -> None:
    """InputError for what is no topic filter (MQTT 3.1.1, 4.7.1)."""
    levels = topic_filter.split("/")
    for depth, level in enumerate(levels):
        last = depth == len(levels) - 1
        if ("#" in level and (level != "#" or not last)) or ("+" in level and level != "+"):
            raise InputError(
                f"{url.text}: {topic_filter} is no topic filter; `+` stands for one whole level, "
                "`#` for all that follow, at the end"
            )


def fixed_part(topic_filter: str) -> str:
    """The levels of a filter before its first wildcard, with the slash."""
    levels: list[str] = []
    for level in topic_filter.split("/"):
        if level in ("#", "+"):
            break
        levels.append(level)
    return "".join(f"{level}/" for level in levels)
