"""Quantities as people write them: `90`, `3m`, `10ms`; `1/day`, `2/week`."""

import math
import re

from runglight.errors import InputError

_SECONDS = {"ms": 0.001, "s": 1.0, "min": 60.0, "m": 60.0, "h": 3600.0, "d": 86400.0}
_PER_DAY = {
    "m": 1440.0,
    "min": 1440.0,
    "minute": 1440.0,
    "h": 24.0,
    "hour": 24.0,
    "d": 1.0,
    "day": 1.0,
    "shift": 3.0,
    "w": 1 / 7,
    "week": 1 / 7,
    "month": 1 / 30,
    "year": 1 / 365,
}
_DURATION = re.compile(r"\s*([0-9]*\.?[0-9]+(?:e-?[0-9]+)?)\s*([a-z]*)\s*")
_RATE = re.compile(r"\s*([0-9]*\.?[0-9]+(?:e-?[0-9]+)?)\s*(?:/|per)\s*([a-z]+)\s*")


def duration_s(text: str, name: str) -> float:
    """Seconds of `90`, `1.5s`, `10ms`, `3m`, `1h`; `name` is the option, for the error."""
    match = _DURATION.fullmatch(text.lower())
    unit = (match[2] or "s") if match else ""
    if match is None or unit not in _SECONDS or not math.isfinite(float(match[1])):
        raise InputError(
            f"{name}: {text!r} is not a duration; write seconds, or a number with ms, s, m, h or d"
        )
    return float(match[1]) * _SECONDS[unit]


def rate_per_day(text: str, name: str = "--false-alarms") -> float:
    """Times per day of `1/day`, `2/week`, `0.5/h`."""
    match = _RATE.fullmatch(text.lower())
    if match is None or match[2] not in _PER_DAY:
        raise InputError(
            f"{name}: {text!r} is not a rate; write for example 1/day, 2/week or 0.5/h"
        )
    rate = float(match[1]) * _PER_DAY[match[2]]
    if not 0 < rate < math.inf:
        raise InputError(f"{name}: {text!r} must be above zero")
    return rate
