"""A full disk stops a recording with a sentence, and early enough to lose nothing."""

import errno
import shutil
import sqlite3
from pathlib import Path

from runglight.errors import InputError
from runglight.moments import iso

RESERVE_BYTES = 100_000_000
"""What a recording leaves free: the computer it runs on needs some, too."""

_FULL = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}


def free_bytes(directory: Path) -> int:
    """What may still be written to the disk of a directory."""
    return shutil.disk_usage(directory).free


def check_reserve(directory: Path, reserve_bytes: int, until_ns: int) -> None:
    """InputError where less than the reserve is free."""
    free = free_bytes(directory)
    if free < reserve_bytes:
        raise InputError(
            f"{directory}: recording stopped, because only {free / 1e6:,.0f} MB are free on its "
            f"disk and {reserve_bytes / 1e6:,.0f} MB are kept in reserve; {_kept(until_ns)}; "
            "free some space, then record on"
        )


def stopped(directory: Path, error: sqlite3.Error | OSError, until_ns: int) -> InputError:
    """What the user is told when the disk refuses."""
    if isinstance(error, sqlite3.Error):
        full = getattr(error, "sqlite_errorcode", 0) & 0xFF == sqlite3.SQLITE_FULL
    else:
        full = error.errno in _FULL
    why = "its disk is full" if full else f"its disk cannot be written ({error})"
    mend = "free some space" if full else "check the disk"
    return InputError(
        f"{directory}: recording stopped, because {why}; {_kept(until_ns)}; {mend}, then record on"
    )


def _kept(until_ns: int) -> str:
    return f"everything up to {iso(until_ns)} is kept" if until_ns else "nothing was recorded yet"
