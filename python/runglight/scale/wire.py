"""How changes, gaps and heartbeats are written to a topic: the other end of `message_formats`."""

from __future__ import annotations

import json
import struct
from collections.abc import Callable
from typing import Literal, TypeAlias

GAP = "\0gap"
"""In place of a signal: nothing was recorded from `value` (nanoseconds) to the row's time."""

_FIXED = struct.Struct("<qq")

Encoder: TypeAlias = Callable[[int, str, int], bytes]
"""Takes time (nanoseconds since 1970), signal and value; a heartbeat has no signal."""


def encode_binary(time_ns: int, signal: str = "", value: int = 0) -> bytes:
    """int64 time, int64 value, both little-endian, and the name in UTF-8."""
    return _FIXED.pack(time_ns, value) + signal.encode()


def encode_json(time_ns: int, signal: str = "", value: int = 0) -> bytes:
    """`{"time": …, "signal": …, "value": …}`."""
    if not signal:
        return json.dumps({"time": time_ns}).encode()
    if signal == GAP:
        return json.dumps({"time": time_ns, "gap": value}).encode()
    return json.dumps({"time": time_ns, "signal": signal, "value": value}).encode()


ENCODERS: dict[Literal["json", "binary"], Encoder] = {
    "json": encode_json,
    "binary": encode_binary,
}
