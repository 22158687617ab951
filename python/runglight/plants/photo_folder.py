"""Photos of a simulated machine, put into a folder as a camera would put them."""

from __future__ import annotations

import os
from pathlib import Path

from runglight.errors import InputError
from runglight.plants.running import PlantPhoto


class PhotoFolder:
    """Writes JPEGs named by their time; each appears in the folder as a whole."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.taken = 0
        """Photos so far."""
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(
                f"--photos {folder}: cannot be made ({error.strerror}); name a folder"
            ) from None

    def put(self, photo: PlantPhoto) -> Path:
        """Writes one photo; InputError where the folder cannot be written to."""
        from runglight.recording.photos import name_of  # noqa: PLC0415

        target = self.folder / name_of(photo.time_ns)
        growing = target.with_suffix(".part")
        try:
            growing.write_bytes(photo.content)
            os.replace(growing, target)
        except OSError as error:
            raise InputError(
                f"{target}: cannot be written ({error.strerror}); free some space or name "
                "another folder"
            ) from None
        self.taken += 1
        return target
