"""What lies in the served directory: recordings, logs, models and nets, each under an id.

A client only ever names ids. They are looked up among what was found on the disk, and never
become part of a path.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from runglight.errors import InputError
from runglight.recording.layout import is_recording

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

Kind = Literal["recording", "log", "model", "net", "next"]
SOURCES: tuple[Kind, ...] = ("recording", "log")
"""What signals can be read from."""
LOG_ENDINGS = (".csv", ".parquet", ".xes", ".vcd")
EVENTS = ".events.csv"
"""Events that were declared for a log: `line3.events.csv` beside `line3.csv`."""
NET_ENDING = ".pnml"
NO_LOGS = frozenset({"symbols.csv", "events.csv"})
DEEP = 2
"""Directories within directories that are looked into."""
AT_MOST = 2000


@dataclass(frozen=True, slots=True)
class Item:
    """One thing in the directory."""

    id: str
    name: str
    """Its path within the directory, for people."""
    kind: Kind
    path: Path


class Catalogue:
    """The directory as it is; every look is a new one."""

    def __init__(self, directory: Path) -> None:
        self.directory = directory

    def items(self, kind: Kind | None = None) -> list[Item]:
        """What there is, by name."""
        found = sorted(self._walk(self.directory, DEEP), key=lambda item: item.name)[:AT_MOST]
        return [item for item in found if kind is None or item.kind == kind]

    def item(self, item_id: str, *kinds: Kind) -> Item:
        """What has this id; InputError where nothing (of these kinds) has."""
        for item in self.items():
            if item.id == item_id and (not kinds or item.kind in kinds):
                return item
        named = " or ".join(kinds) or "thing"
        raise InputError(f"there is no {named} of this name any more; look at the list again")

    def of_path(self, path: Path) -> Item | None:
        """The item at a path, where it lies in the directory."""
        return next((item for item in self.items() if item.path.samefile(path)), None)

    def _walk(self, directory: Path, deep: int) -> Iterator[Item]:
        try:
            entries = sorted(directory.iterdir())
        except OSError:
            return
        for path in entries:
            if path.name.startswith("."):
                continue
            kind = _kind(path)
            if kind is not None:
                name = path.relative_to(self.directory).as_posix()
                yield Item(_id(name), name, kind, path)
            elif deep > 0 and path.is_dir() and not path.is_symlink():
                yield from self._walk(path, deep - 1)


def free_name(directory: Path, wanted: str, ending: str) -> Path:
    """A path in the directory that is not taken, called as like `wanted` as is safe."""
    safe = "".join(letter if letter.isalnum() or letter in "-_" else "-" for letter in wanted)
    stem = safe.strip("-")[:60] or "unnamed"
    path = directory / f"{stem}{ending}"
    number = 2
    while path.exists():
        path = directory / f"{stem}-{number}{ending}"
        number += 1
    return path


def _kind(path: Path) -> Kind | None:
    if path.is_dir():
        if is_recording(path):
            return "recording"
        if (path / "next.json").is_file():
            return "next"
        return "model" if (path / "manifest.json").is_file() else None
    name = path.name.lower()
    if path.suffix.lower() == NET_ENDING:
        return "net"
    if path.suffix.lower() in LOG_ENDINGS and not (name in NO_LOGS or name.endswith(EVENTS)):
        return "log"
    return None


def _id(name: str) -> str:
    return hashlib.blake2b(name.encode(errors="surrogateescape"), digest_size=6).hexdigest()
