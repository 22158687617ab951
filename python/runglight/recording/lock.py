"""One recorder per directory. The lock is the operating system's: it ends with the process."""

import os
import sys
from pathlib import Path
from typing import IO

from runglight.errors import InputError
from runglight.recording.layout import LOCK

if sys.platform == "win32":
    import msvcrt

    def _try_lock(stream: IO[bytes]) -> None:
        msvcrt.locking(stream.fileno(), msvcrt.LK_NBLCK, 1)
else:
    import fcntl

    def _try_lock(stream: IO[bytes]) -> None:
        fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)


class DirectoryLock:
    """Held from construction to `release`; InputError where another recorder holds it."""

    def __init__(self, directory: Path) -> None:
        self._stream: IO[bytes] = (directory / LOCK).open("ab+")
        try:
            _try_lock(self._stream)
        except OSError:
            self._stream.seek(0)
            owner = self._stream.read(32).decode("ascii", "replace").strip()
            self._stream.close()
            process = f" (process {owner})" if owner.isdecimal() else ""
            raise InputError(
                f"{directory}: another recorder{process} is writing here; "
                "stop it, or record to another directory"
            ) from None
        # For the sentence above only: a number left by a killed process locks nothing.
        self._stream.truncate(0)
        self._stream.write(f"{os.getpid()}\n".encode())
        self._stream.flush()

    def release(self) -> None:
        """Lets go; may be called twice."""
        self._stream.close()
