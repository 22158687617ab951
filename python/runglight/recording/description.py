"""`recording.json`: what was tapped, and what the numbers of the tail stand for."""

from __future__ import annotations

from pathlib import Path

import msgspec

from runglight._engine import __version__
from runglight.errors import InputError
from runglight.recording.durable import write_durably
from runglight.recording.layout import DESCRIPTION

FORMAT = 1
"""Raised when an older runglight could no longer read what is written."""


class RecordedSignal(msgspec.Struct, frozen=True):
    """A signal: its name in the log, and where the PLC keeps it."""

    name: str
    address: str = ""
    type: str = "BOOL"
    signal_class: str = msgspec.field(default="input", name="class")
    description: str = ""


class Description(msgspec.Struct):
    """The whole of `recording.json`. `signals` only grows: the tail counts on their numbers."""

    format: int
    created: str
    """ISO 8601, UTC."""
    source: str
    """What is tapped, without secrets."""
    interval_ns: int | None = None
    """Wanted time between two scans; None: the source sends by itself, 0: as fast as it goes."""
    runglight: str = __version__
    signals: list[RecordedSignal] = []


class _Head(msgspec.Struct):
    format: int


def read_description(directory: Path) -> Description:
    """Reads `recording.json`; InputError where it is damaged or from a newer version."""
    path = directory / DESCRIPTION
    try:
        content = path.read_bytes()
        written = msgspec.json.decode(content, type=_Head).format
        if written > FORMAT:
            raise InputError(
                f"{path}: written by a newer runglight (format {written}, this one reads "
                f"{FORMAT}); install that version"
            )
        description = msgspec.json.decode(content, type=Description)
    except FileNotFoundError:
        raise InputError(
            f"{directory}: is no recording, because it has no {DESCRIPTION}; check the path"
        ) from None
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise InputError(
            f"{path}: is damaged ({error}); bring it back from a copy, or read the files of "
            f"{directory / 'segments'} one by one: each is a log"
        ) from None
    names = [signal.name for signal in description.signals]
    if len(set(names)) < len(names):
        raise InputError(f"{path}: is damaged (a signal stands in it twice); bring back a copy")
    return description


def write_description(directory: Path, description: Description) -> None:
    """Replaces `recording.json` as a whole; it is on the disk when this returns."""
    text = msgspec.json.format(msgspec.json.encode(description), indent=1)
    write_durably(directory / DESCRIPTION, text + b"\n")
