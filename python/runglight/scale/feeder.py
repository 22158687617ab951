"""From a tap, or a log, to a Kafka topic: what `runglight spark feed` does.

One producer sends one plant's changes under one key, so that they stay in one partition and in
order. Heartbeats say that time went on, and gaps that nothing was recorded, in the topic's format.
"""

from __future__ import annotations

import asyncio
from dataclasses import dataclass
from typing import TYPE_CHECKING

from runglight.errors import InputError
from runglight.scale.wire import ENCODERS, GAP
from runglight.taps.base import Batch, Gap

if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any, Literal

    from runglight.taps.base import Tap

HEARTBEAT_NS = 1_000_000_000
"""A topic hears at least this often how far time has come."""
_SEND_WITHIN_S = 30.0


@dataclass
class Fed:
    """What was sent so far."""

    changes: int = 0
    gaps: int = 0
    heartbeats: int = 0


class Feeder:
    """Sends what a tap delivers."""

    def __init__(
        self,
        servers: str,
        topic: str,
        *,
        plant: str,
        format: Literal["json", "binary"],
        options: Mapping[str, str],
    ) -> None:
        try:
            from confluent_kafka import Producer  # noqa: PLC0415
        except ModuleNotFoundError:
            raise InputError(
                'spark feed needs confluent-kafka: pip install "runglight[kafka]"'
            ) from None
        self._topic = topic
        self._key = plant.encode()
        self._encode = ENCODERS[format]
        self._producer: Any = Producer(
            {
                "bootstrap.servers": servers,
                # In order and once, for as long as it takes: the tap waits, and tells a gap where
                # it waited too long.
                "enable.idempotence": True,
                "message.timeout.ms": 0,
                "linger.ms": 5,
                **options,
            }
        )
        self._heard_ns = 0
        self.fed = Fed()

    async def feed(self, tap: Tap) -> None:
        """Sends until the tap ends."""
        async with tap:
            async for batch in tap:
                await self._send_batch(tap, batch)

    def end(self) -> int:
        """Waits a while until the broker has everything; returns how many messages it has not."""
        left: int = self._producer.flush(_SEND_WITHIN_S)
        return left

    async def _send_batch(self, tap: Tap, batch: Batch) -> None:
        for mark in batch.marks:
            if isinstance(mark, Gap):
                await self._send(mark.end_ns, GAP, mark.start_ns)
                self.fed.gaps += 1
        columns = (batch.time_ns, batch.signal_index, batch.value)
        for time_ns, index, value in zip(*(each.tolist() for each in columns), strict=True):
            await self._send(time_ns, tap.signals[index].name, value)
        self.fed.changes += len(batch)
        if len(batch):
            self._heard_ns = int(batch.time_ns[-1])
        elif batch.until_ns - self._heard_ns >= HEARTBEAT_NS:
            await self._send(batch.until_ns, "", 0)
            self._heard_ns = batch.until_ns
            self.fed.heartbeats += 1
        self._producer.poll(0)

    async def _send(self, time_ns: int, signal: str, value: int) -> None:
        message = self._encode(time_ns, signal, value)
        while True:
            try:
                self._producer.produce(self._topic, message, self._key)
            except BufferError:
                # The broker is away or slow: the tap is read no further meanwhile.
                self._producer.poll(0)
                await asyncio.sleep(0.05)
            else:
                return
