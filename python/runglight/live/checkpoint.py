"""The monitor's state on disk, so that a restart goes on where watching ended."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from runglight.errors import InputError
from runglight.replacing import replacing

if TYPE_CHECKING:
    from pathlib import Path

    from runglight.model import Monitor, NominalModel


class Checkpoint:
    """One file, replaced as a whole."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def restore(self, model: NominalModel) -> tuple[Monitor, str | None]:
        """The monitor to go on with, and one sentence where it had to start afresh.

        A state of another model (it was learned anew, or a path was confirmed) and a damaged one
        cannot be gone on from; a machine is not left unwatched for that.
        """
        if not self.path.exists():
            return model.monitor(), None
        try:
            return model.monitor(self.path.read_bytes()), None
        except InputError as error:
            reason = str(error).partition(";")[0]
            return model.monitor(), f"{self.path}: {reason}; watching starts afresh"

    def save(self, state: bytes) -> None:
        """Replaces the file; it is on disk when this returns."""
        with replacing(self.path) as temporary, temporary.open("wb") as file:
            file.write(state)
            file.flush()
            os.fsync(file.fileno())
