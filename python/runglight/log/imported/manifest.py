"""`imported.json`: which segments count, and how far the source was read.

Segments and bookmark stand in one file, and that file is replaced whole: whatever moment a process
is killed at, the rows of the segments are those before the bookmark, none doubled, none lost.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Literal

import msgspec

from runglight.errors import InputError
from runglight.replacing import replacing

FILE = "imported.json"


class Segment(msgspec.Struct, forbid_unknown_fields=True):
    """A Parquet file beside the manifest."""

    file: str
    rows: int


class Manifest(msgspec.Struct, forbid_unknown_fields=True):
    """What a directory holds."""

    source: str
    """What was read, without user and password."""
    format: Literal[1] = 1
    segments: list[Segment] = []
    newest_ns: int | None = None
    """Time of the newest row."""
    skipped: int = 0
    """Rows that were left out, because they could not be read or were not good."""
    bookmark: dict[str, Any] | None = None
    """How far the source was read; its form is the source's own."""

    @classmethod
    def load(cls, directory: Path) -> Manifest | None:
        """The manifest of a directory, None without one; InputError for a damaged one."""
        path = directory / FILE
        try:
            manifest = msgspec.json.decode(path.read_bytes(), type=cls)
        except FileNotFoundError:
            return None
        except (msgspec.DecodeError, UnicodeDecodeError) as error:
            raise damaged(path, str(error)) from None
        except OSError as error:
            raise InputError(f"{path}: cannot be read: {error.strerror}") from None
        if any(Path(segment.file).name != segment.file for segment in manifest.segments):
            raise damaged(path, "a segment lies outside the directory")
        return manifest

    def save(self, directory: Path) -> None:
        """Takes the place of the manifest before it, for good: a loss of power does not undo it."""
        with replacing(directory / FILE) as temporary:
            temporary.write_bytes(msgspec.json.format(msgspec.json.encode(self), indent=1))
            to_disk(temporary)
        to_disk(directory)


def damaged(path: Path, problem: str) -> InputError:
    """The sentence on a file that is not as it was written."""
    return InputError(
        f"{path}: is damaged ({problem}); restore it from a backup, or import to a new directory"
    )


def to_disk(path: Path) -> None:
    """Has the system write out a file, or a directory's names."""
    if path.is_dir() and os.name == "nt":
        return  # Windows opens no directories.
    handle = os.open(path, os.O_RDONLY if os.name != "nt" else os.O_RDWR)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
