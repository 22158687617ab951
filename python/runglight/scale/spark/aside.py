"""What a task read beside changes: heartbeats, and messages that could not be read.

It travels like a chunk, so that the watermark sees the heartbeats too: a filter that left them out
on the way would be moved before the watermark by Spark.
"""

from __future__ import annotations

from collections.abc import Iterable

import msgspec

from runglight.scale.spark import notices

PART = "\0aside"
"""Where it stands in place of a part's name."""


class Aside(msgspec.Struct, frozen=True):
    """Of one task and one packing."""

    newest_ns: int
    unreadable: int = 0
    first: str = ""


_decoder = msgspec.msgpack.Decoder(Aside)


def packed(aside: Aside) -> bytes:
    """As bytes."""
    return msgspec.msgpack.encode(aside)


def told(pieces: Iterable[bytes]) -> list[str]:
    """Notices of what could not be read, as JSON lines."""
    return [
        notices.unreadable(aside.unreadable, aside.first, aside.newest_ns)
        for aside in map(_decoder.decode, pieces)
        if aside.unreadable
    ]
