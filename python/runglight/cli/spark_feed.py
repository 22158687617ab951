"""`runglight spark feed`: from a live source or a log to a Kafka topic."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from runglight.cli import terminal
from runglight.cli.exit_codes import DONE
from runglight.errors import InputError
from runglight.quantities import duration_s

if TYPE_CHECKING:
    from runglight.scale.feeder import Feeder
    from runglight.taps.base import Tap


def spark_feed(
    source: str,
    topic: str,
    /,
    *,
    plant: str = "",
    format: Literal["json", "binary"] = "json",
    duration: Annotated[str | None, Parameter(name="--for")] = None,
) -> int:
    """Send the changes of a machine to a Kafka topic, for `runglight spark watch` to watch.

    Neither Spark nor Java is needed for it. All changes of one machine go to one partition, in
    order. A lost connection to the machine becomes a gap in the topic; while the broker is away
    nothing is dropped, and the source is read no further.

    Parameters
    ----------
    source: str
        A live address (`opcua://…`, `mqtt://…`, `modbus://…`, `s7://…`), or `replay:FILE?speed=max`
        for a log.
    topic: str
        `kafka://HOST:PORT/TOPIC`; what follows a `?` are options of librdkafka.
    plant: str
        Name of the plant, sent as the key of each message (`--plant-by-key` of the watch).
    format: str
        What a message holds (default: `json`): `json` or `binary`, which is shorter.
    duration: str
        End after this time: `10m`.

    """
    from runglight.scale.feeder import Feeder  # noqa: PLC0415
    from runglight.scale.topic import topic_of  # noqa: PLC0415
    from runglight.taps import open_tap  # noqa: PLC0415

    seconds = None if duration is None else duration_s(duration, "--for")
    place = topic_of(topic)
    tap = open_tap(source)
    feeder = Feeder(place.servers, place.name, plant=plant, format=format, options=place.options)
    left = 0
    try:
        with suppress(TimeoutError):
            asyncio.run(_feed(feeder, tap, seconds))
    finally:
        left = feeder.end()
        fed = feeder.fed
        terminal.note(
            f"sent {fed.changes:,} changes, {fed.gaps:,} gaps and {fed.heartbeats:,} heartbeats"
        )
    if left:
        raise InputError(
            f"{topic}: {left:,} messages did not reach the broker and are lost; is it there? Then "
            "feed the recording"
        )
    return DONE


async def _feed(feeder: Feeder, tap: Tap, seconds: float | None) -> None:
    async with asyncio.timeout(seconds):
        await feeder.feed(tap)
