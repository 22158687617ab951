"""Moments: nanoseconds since 1970 (UTC) as people, files and Python write them."""

from datetime import UTC, datetime, timedelta

from runglight.errors import InputError

_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)


def nanoseconds(time: datetime | int) -> int:
    """Of an aware datetime, or of nanoseconds themselves; InputError without a time zone."""
    if isinstance(time, int):
        return time
    if time.tzinfo is None:
        raise InputError(f"{time.isoformat()} has no time zone; give an aware datetime")
    return (time - _EPOCH) // timedelta(microseconds=1) * 1000


def iso(time_ns: int) -> str:
    """`2026-01-31T06:00:00.123Z`, to the millisecond; nanoseconds where no calendar has them."""
    try:
        time = _EPOCH + timedelta(milliseconds=time_ns // 1_000_000)
    except OverflowError:
        return f"{time_ns} ns"
    return time.isoformat(timespec="milliseconds").replace("+00:00", "Z")


def now_iso() -> str:
    """Now, by the clock of this computer."""
    return datetime.now(UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")
