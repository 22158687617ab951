"""What the files of a recording are called."""

from pathlib import Path

DESCRIPTION = "recording.json"
TAIL = "tail.sqlite"
SEGMENTS = "segments"
PHOTOS = "photos"
EVENTS = "events.csv"
LOCK = "recorder.lock"


def is_recording(path: Path) -> bool:
    """Whether a path is the directory of a recording."""
    return (path / DESCRIPTION).is_file()


def changes_file(directory: Path, number: int) -> Path:
    """The changes of a sealed segment, as a change log in Parquet."""
    return directory / SEGMENTS / f"{number:06d}.parquet"


def scans_file(directory: Path, number: int) -> Path:
    """The scans and marks of a sealed segment, as NumPy arrays; a segment is complete with it."""
    return directory / SEGMENTS / f"{number:06d}.scans.npz"


def sealed_numbers(directory: Path) -> list[int]:
    """Numbers of the segments that are complete, in order."""
    names = (path.name.partition(".")[0] for path in (directory / SEGMENTS).glob("*.scans.npz"))
    return sorted(int(name) for name in names if name.isdecimal())
