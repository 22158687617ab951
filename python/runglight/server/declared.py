"""Declared events of a recording or log, as they lie on the disk."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Annotated

import msgspec
import numpy as np

from runglight.errors import InputError
from runglight.identification.events import Events, read_events
from runglight.recording.layout import EVENTS as IN_RECORDING
from runglight.server.answers import FARTHEST
from runglight.server.catalogue import EVENTS as BESIDE_LOG

if TYPE_CHECKING:
    from pathlib import Path

    from runglight.server.catalogue import Item

MOST = 20_000
LONGEST_LABEL = 80


class Event(msgspec.Struct, frozen=True):
    """One moment, in nanoseconds from the origin of its source."""

    at: Annotated[int, msgspec.Meta(ge=-FARTHEST, le=FARTHEST)]
    label: str = ""


class Declared(msgspec.Struct, frozen=True):
    """What a file holds, and which version of it that is."""

    file: str
    events: list[Event]
    version: str | None
    """None where there is no file yet."""


def file_of(item: Item) -> Path:
    """Where events of an item are kept: in the recording, or beside the log."""
    if item.kind == "recording":
        return item.path / IN_RECORDING
    return item.path.with_name(item.path.stem + BESIDE_LOG)


def read(item: Item, origin_ns: int, date: str | None) -> Declared:
    """What has been declared; InputError where the file is none."""
    path = file_of(item)
    version = version_of(path)
    if version is None:
        return Declared(path.name, [], None)
    found = read_events(path, date=date)
    labels = [label or "" for label in found.labels]
    times = (found.time_ns - origin_ns).tolist()
    return Declared(path.name, list(map(Event, times, labels)), version)


def write(item: Item, origin_ns: int, events: list[Event], version: str | None) -> str:
    """Replaces the file and says which version it is now.

    InputError where it is no longer the one that was read: it is somebody's work.
    """
    path = file_of(item)
    if version_of(path) != version:
        raise InputError(
            f"{path.name} was changed by somebody else meanwhile; load it again before you save"
        )
    of(events, origin_ns).write(path)
    return version_of(path) or ""


def of(events: list[Event], origin_ns: int) -> Events:
    """As identification takes them; InputError where they are too many."""
    if len(events) > MOST:
        raise InputError(f"{len(events):,} events are more than the {MOST:,} that are taken")
    for event in events:
        if len(event.label) > LONGEST_LABEL:
            raise InputError(f"a label has at most {LONGEST_LABEL} characters: {event.label[:20]}…")
    ordered = sorted(events, key=lambda event: event.at)
    times = np.array([origin_ns + event.at for event in ordered], np.int64)
    return Events(times, tuple(event.label.strip() or None for event in ordered))


def version_of(path: Path) -> str | None:
    """Of what a file holds; None without a file."""
    if not path.is_file():
        return None
    return hashlib.blake2b(path.read_bytes(), digest_size=8).hexdigest()
