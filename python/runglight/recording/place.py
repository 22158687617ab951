"""The directory a recorder writes to: made or gone on with, and swept."""

from __future__ import annotations

import time
from pathlib import Path

from runglight.errors import InputError
from runglight.moments import iso
from runglight.recording import disk
from runglight.recording.description import (
    FORMAT,
    Description,
    read_description,
    write_description,
)
from runglight.recording.layout import (
    DESCRIPTION,
    LOCK,
    PHOTOS,
    SEGMENTS,
    is_recording,
    sealed_numbers,
)
from runglight.recording.segment import read_head
from runglight.recording.tail import TailState


def prepare(directory: Path) -> None:
    """A place for a recording: new, empty, or a recording; InputError for anything else."""
    if directory.exists() and not directory.is_dir():
        raise InputError(f"{directory}: is a file; name a directory to record to")
    try:
        if directory.is_dir() and not is_recording(directory):
            # What a recorder leaves that was killed before it described anything is no hindrance.
            ours = (LOCK, SEGMENTS, f".{DESCRIPTION}.")
            if any(not path.name.startswith(ours) for path in directory.iterdir()):
                raise InputError(
                    f"{directory}: is not empty and no recording; name another directory"
                )
        (directory / SEGMENTS).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise disk.stopped(directory, error, 0) from None


def sweep(directory: Path) -> None:
    """Takes away the temporary files of a recorder that was killed."""
    for place, names in ((directory, f".{DESCRIPTION}.*"), (SEGMENTS, ".*"), (PHOTOS, ".*")):
        for path in (directory / place).glob(names):
            path.unlink()


def described(directory: Path, source: str, interval_ns: int | None) -> Description:
    """The description there is, brought up to date, or a new one."""
    if is_recording(directory):
        description = read_description(directory)
        if (description.source, description.interval_ns) == (source, interval_ns):
            return description
        description.source, description.interval_ns = source, interval_ns
    else:
        created = iso(time.time_ns())
        description = Description(FORMAT, created, source, interval_ns)
    write_description(directory, description)
    return description


def state_of_segments(directory: Path) -> TailState:
    """Where recording stands if there is no tail: after the segments."""
    numbers = sealed_numbers(directory)
    if not numbers:
        return TailState()
    head = read_head(directory, numbers[-1])
    # Every segment has at least one block, whose numbers go on.
    return TailState(head.number, head.number, head.number, head.until_ns)
