"""Photos of a recording: files named by their time, so that the directory is its own index."""

from __future__ import annotations

import re
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path

from runglight.recording.durable import write_durably
from runglight.recording.layout import PHOTOS

ENDINGS = {".jpg": ".jpg", ".jpeg": ".jpg", ".png": ".png"}
_NAME = re.compile(r"(\d{8}T\d{6})\.(\d{9})Z\.(?:jpg|png)")
_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
_MILLISECOND_NS = 1_000_000


@dataclass(frozen=True, slots=True, order=True)
class Photo:
    """A photo and when it was taken."""

    time_ns: int
    path: Path


def photos(directory: Path) -> list[Photo]:
    """The photos of a recording in time order."""
    found = []
    for path in (directory / PHOTOS).glob("*Z.*"):
        time_ns = time_of(path.name)
        if time_ns is not None:
            found.append(Photo(time_ns, path))
    return sorted(found)


def keep_photo(directory: Path, time_ns: int, content: bytes, ending: str = ".jpg") -> Path:
    """Writes a photo into a recording; one of the same time moves on by a millisecond."""
    folder = directory / PHOTOS
    folder.mkdir(exist_ok=True)
    while (target := folder / name_of(time_ns, ending)).exists():
        time_ns += _MILLISECOND_NS
    write_durably(target, content)
    return target


def name_of(time_ns: int, ending: str = ".jpg") -> str:
    """`20260131T060000.123456789Z.jpg`."""
    seconds, nanoseconds = divmod(time_ns, 1_000_000_000)
    return f"{_EPOCH + timedelta(seconds=seconds):%Y%m%dT%H%M%S}.{nanoseconds:09d}Z{ending}"


def time_of(name: str) -> int | None:
    """Nanoseconds since 1970 that a photo's name tells; None for any other name."""
    match = _NAME.fullmatch(name)
    if match is None:
        return None
    try:
        moment = datetime.strptime(match[1], "%Y%m%dT%H%M%S").replace(tzinfo=UTC)
    except ValueError:
        return None
    return (moment - _EPOCH) // timedelta(seconds=1) * 1_000_000_000 + int(match[2])
