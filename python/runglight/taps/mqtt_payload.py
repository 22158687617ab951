"""What a plain MQTT message says: members, each with a value and perhaps a time.

Taken are `1`, `-7`, `true`, `ON`, `"off"`, JSON numbers and booleans, `{"value": …, "time": …}`
and a flat object of several members. Floats, other text, lists and nested objects are not values.
"""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime

import msgspec

from runglight.taps.subscription import INT64

WORDS = {"true": 1, "on": 1, "yes": 1, "false": 0, "off": 0, "no": 0}
VALUE = ("value", "val", "v")
TIME = ("time", "timestamp", "ts", "t")
_INTEGER = re.compile(r"[+-]?[0-9]{1,19}")
# Numbers since 1970 by their size: seconds until the year 5138, then ms, us, ns.
_UNITS_NS = ((1e11, 1_000_000_000), (1e14, 1_000_000), (1e17, 1_000), (math.inf, 1))


@dataclass(frozen=True, slots=True)
class Member:
    """One value of a message: `name` is empty where the topic says it all."""

    name: str
    value: int | None
    stamp_ns: int | None
    type: str = "LINT"
    reason: str = ""
    """Why there is no value."""


def read_payload(payload: bytes) -> list[Member]:
    """The members of a message; never raises."""
    try:
        text = payload.decode().strip()
    except UnicodeDecodeError:
        return [Member("", None, None, reason="is not text")]
    if not text:
        return [Member("", None, None, reason="is empty")]
    try:
        content = msgspec.json.decode(text)
    except (msgspec.DecodeError, RecursionError):
        content = text
    if not isinstance(content, dict):
        return [_member("", content, None)]
    keys = {key.lower(): key for key in content}
    stamp_key = next((keys[name] for name in TIME if name in keys), None)
    stamp_ns = None if stamp_key is None else read_time(content[stamp_key])
    value_key = next((keys[name] for name in VALUE if name in keys), None)
    if value_key is not None:
        return [_member("", content[value_key], stamp_ns)]
    return _flat(content, None if stamp_ns is None else stamp_key, stamp_ns)


def _flat(
    content: Mapping[str, object], stamp_key: str | None, stamp_ns: int | None
) -> list[Member]:
    members = [
        _member(name, value, stamp_ns) for name, value in content.items() if name != stamp_key
    ]
    return members or [Member("", None, None, reason="is an object without members")]


def _member(name: str, content: object, stamp_ns: int | None) -> Member:
    if isinstance(content, bool):
        return Member(name, int(content), stamp_ns, "BOOL")
    if isinstance(content, str):
        word = WORDS.get(content.strip().lower())
        if word is not None:
            return Member(name, word, stamp_ns, "BOOL")
        if _INTEGER.fullmatch(content.strip()):
            content = int(content)
    if isinstance(content, int):
        if content in INT64:
            return Member(name, content, stamp_ns)
        return Member(name, None, None, reason="is no 64-bit integer")
    return Member(name, None, None, reason=_called(content))


def _called(content: object) -> str:
    if isinstance(content, float):
        return "is a measurement (float), neither boolean nor integer"
    if isinstance(content, str):
        return "is text, neither boolean nor integer"
    if content is None:
        return "is null"
    return f"is a nested {'list' if isinstance(content, list) else 'object'}"


def read_time(content: object) -> int | None:
    """Nanoseconds since 1970 of ISO 8601 or of a number (s, ms, us, ns by its size)."""
    if isinstance(content, str):
        if re.fullmatch(r"[0-9]+(\.[0-9]*)?", content):
            return _number_ns(float(content) if "." in content else int(content))
        try:
            stamp = datetime.fromisoformat(content)
        except ValueError:
            return None
        if stamp.tzinfo is None:
            stamp = stamp.replace(tzinfo=UTC)
        try:
            since = stamp - datetime(1970, 1, 1, tzinfo=UTC)
        except OverflowError:
            return None
        nanoseconds = (since.days * 86_400 + since.seconds) * 1_000_000_000
        nanoseconds += since.microseconds * 1000
        return nanoseconds if nanoseconds in INT64 else None
    if isinstance(content, bool) or not isinstance(content, int | float):
        return None
    return _number_ns(content)


def _number_ns(number: int | float) -> int | None:
    if not math.isfinite(number) or number <= 0:
        return None
    unit_ns = next(unit_ns for below, unit_ns in _UNITS_NS if number < below)
    nanoseconds = number * unit_ns if isinstance(number, int) else round(number * unit_ns)
    return nanoseconds if nanoseconds in INT64 else None
