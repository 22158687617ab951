"""Files that are on the disk, under their name and whole, when the function returns."""

import os
import secrets
from pathlib import Path


def write_durably(target: Path, content: bytes) -> None:
    """Writes to a temporary name, syncs, renames, and syncs the directory."""
    temporary = target.with_name(f".{target.name}.{secrets.token_hex(4)}")
    try:
        with temporary.open("xb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        temporary.replace(target)
    finally:
        temporary.unlink(missing_ok=True)
    sync_directory(target.parent)


def sync_directory(directory: Path) -> None:
    """The names in a directory survive a power cut; Windows does so by itself."""
    if os.name != "posix":
        return
    descriptor = os.open(directory, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
