"""An imported directory as one log."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from runglight import _engine
from runglight.errors import InputError
from runglight.log.changelog import Log
from runglight.log.imported.joining import joined
from runglight.log.imported.manifest import FILE, Manifest, damaged
from runglight.log.report import ReadReport

if TYPE_CHECKING:
    from runglight.log.imported.manifest import Segment

_ATTEMPTS = 5


def is_imported(path: Path) -> bool:
    """True for a directory that an import filled."""
    return (path / FILE).is_file()


def read_imported(directory: Path) -> Log:
    """All rows of the directory, also while an import adds to it."""
    for _ in range(_ATTEMPTS):
        manifest = Manifest.load(directory)
        if manifest is None:
            raise InputError(f"{directory}: holds no import; its {FILE} is missing")
        files = [directory / segment.file for segment in manifest.segments]
        try:
            log = joined([read_segment(directory, each) for each in manifest.segments])
        except InputError:
            # An import that runs replaces its last segment by a longer one.
            if Manifest.load(directory) == manifest or all(each.is_file() for each in files):
                raise
            continue
        notes = []
        if manifest.skipped:
            were = "row was" if manifest.skipped == 1 else "rows were"
            notes.append(f"{manifest.skipped:,} {were} left out when it was imported")
        report = ReadReport(format="imported", rows=len(log), notes=notes)
        return Log(log.engine, str(directory), report)
    raise InputError(f"{directory}: changes faster than it can be read; try again")


def read_segment(directory: Path, segment: Segment) -> Log:
    """The rows of one segment; InputError where they are not those that were written."""
    path = directory / segment.file
    if not path.is_file():
        raise damaged(directory / FILE, f"its segment {segment.file} is missing")
    log = Log(_engine.read_log(str(path), '{"format": "parquet"}'))
    if len(log) != segment.rows:
        raise damaged(path, f"{len(log):,} rows instead of {segment.rows:,}")
    return log
