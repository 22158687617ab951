"""Times of any type on one scale, so that a window can be laid over them."""

from __future__ import annotations

from datetime import UTC, date, datetime
from decimal import Decimal
from typing import Any

_UNITS_S = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "s-year1": 1.0}
# By size, as the file reader tells them apart: 1e11 s is the year 5138.
_BY_SIZE = ((1e17, 1e-9), (1e14, 1e-6), (1e11, 1e-3))


def seconds(time: Any, time_format: str | None) -> float | None:
    """Seconds since any one moment; None for text that tells no time to us."""
    if isinstance(time, str):
        return _seconds_of_text(time.strip(), time_format)
    if isinstance(time, datetime):
        return (time if time.tzinfo else time.replace(tzinfo=UTC)).timestamp()
    if isinstance(time, date):
        return time.toordinal() * 86_400.0
    if isinstance(time, int | float | Decimal):
        return _seconds_of_number(float(time), time_format)
    return None


def _seconds_of_number(number: float, time_format: str | None) -> float:
    if unit_s := _UNITS_S.get(time_format or ""):
        return number * unit_s
    return number * next((unit_s for bound, unit_s in _BY_SIZE if abs(number) >= bound), 1.0)


def _seconds_of_text(text: str, time_format: str | None) -> float | None:
    day = text[:10].replace("/", "-").replace(".", "-")
    try:
        return seconds(datetime.fromisoformat(day + text[10:]), None)
    except ValueError:
        try:
            return _seconds_of_number(float(text), time_format)
        except ValueError:
            return None
