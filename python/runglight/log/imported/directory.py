"""Filling a directory step by step."""

from __future__ import annotations

import os
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import msgspec

from runglight.errors import InputError
from runglight.log.imported.joining import joined
from runglight.log.imported.manifest import FILE, Manifest, Segment, to_disk
from runglight.log.imported.reading import read_segment

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from runglight.log.changelog import Log

SEGMENT_ROWS = 100_000
"""A segment of fewer rows is replaced by one that holds the next rows too."""


class ImportDirectory:
    """A directory that one import at a time adds to."""

    def __init__(self, path: Path, manifest: Manifest) -> None:
        self.path = path
        self._manifest = manifest

    @classmethod
    @contextmanager
    def opened(cls, path: Path, source: str) -> Iterator[ImportDirectory]:
        """Opens the directory, or makes it; InputError where it holds something else."""
        try:
            path.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(f"{path}: cannot be made: {error.strerror}") from None
        with _alone_in(path):
            manifest = Manifest.load(path)
            if manifest is None:
                if any(not each.name.startswith(".") for each in path.iterdir()):
                    _refuse_foreign(path)
                manifest = Manifest(source)
            elif manifest.source != source:
                raise InputError(
                    f"{path}: holds an import of {manifest.source}, not of {source}; "
                    "name another directory"
                )
            directory = cls(path, manifest)
            directory._sweep()
            yield directory

    @property
    def rows(self) -> int:
        """Number of rows it holds."""
        return sum(segment.rows for segment in self._manifest.segments)

    @property
    def newest_ns(self) -> int | None:
        """Time of the newest row."""
        return self._manifest.newest_ns

    @property
    def bookmark(self) -> dict[str, Any] | None:
        """How far the source was read."""
        return self._manifest.bookmark

    def add(self, log: Log | None, bookmark: dict[str, Any], skipped: int = 0) -> None:
        """Adds rows and moves the bookmark, both or neither; on disk when it returns."""
        before = self._manifest
        segments = list(before.segments)
        replaced = None
        newest_ns = before.newest_ns
        if log is not None and len(log):
            number = int(segments[-1].file.partition(".")[0]) + 1 if segments else 1
            newest_ns = int(log.columns()[0][-1])
            if before.newest_ns is not None:
                newest_ns = max(newest_ns, before.newest_ns)
            if segments and segments[-1].rows < SEGMENT_ROWS:
                replaced = segments.pop()
                log = joined([read_segment(self.path, replaced), log])
            segments.append(self._written(log, f"{number:06}.parquet"))
        self._manifest = msgspec.structs.replace(
            before,
            segments=segments,
            newest_ns=newest_ns,
            skipped=before.skipped + skipped,
            bookmark=bookmark,
        )
        try:
            self._manifest.save(self.path)
        except OSError as error:
            self._manifest = before
            raise InputError(f"{self.path / FILE}: cannot be written: {error.strerror}") from None
        if replaced is not None:
            (self.path / replaced.file).unlink(missing_ok=True)

    def _written(self, log: Log, name: str) -> Segment:
        # Whole or not at all, and on disk before the manifest speaks of it.
        rows = log.write(self.path / name)
        to_disk(self.path / name)
        to_disk(self.path)
        return Segment(name, rows)

    def _sweep(self) -> None:
        """Removes what an import that was killed left: files of which no manifest speaks."""
        listed = {segment.file for segment in self._manifest.segments}
        for pattern in ("[0-9]*.parquet", ".[0-9]*.parquet*", f".{FILE.partition('.')[0]}.*"):
            for each in self.path.glob(pattern):
                if each.name not in listed:
                    each.unlink(missing_ok=True)


def _refuse_foreign(path: Path) -> None:
    names = sorted(each.name for each in path.iterdir() if not each.name.startswith("."))
    # The first segment may be there without a manifest, where the first import was killed.
    foreign = [name for name in names if name != "000001.parquet"]
    if foreign:
        raise InputError(
            f"{path}: is a directory of other things ({foreign[0]}); "
            "name a new one, or one that an import made"
        )


@contextmanager
def _alone_in(path: Path) -> Iterator[None]:
    """Holds the directory; the system lets go of it however the process ends."""
    if fcntl is None:
        yield
        return
    try:
        handle = os.open(path, os.O_RDONLY)
    except OSError as error:
        raise InputError(f"{path}: cannot be opened: {error.strerror}") from None
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise InputError(f"{path}: another import is writing to it; wait for it") from None
        yield
    finally:
        os.close(handle)
