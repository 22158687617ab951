"""Photos from a folder that fills with images; needs nothing installed."""

from __future__ import annotations

import asyncio
from pathlib import Path

from runglight.recording import exif
from runglight.recording.camera import Camera
from runglight.recording.photos import ENDINGS

LOOK_S = 1.0
"""How often the folder is looked at."""


class ImageFolder(Camera):
    """Copies images that appear in a folder; what was there before is left alone.

    Its time is what the camera wrote into the file (EXIF), else when the file was last changed.
    """

    def __init__(self, folder: Path, recording: Path) -> None:
        super().__init__(recording)
        self._folder = folder
        self._done = self._present()
        self._growing: dict[Path, tuple[int, int]] = {}

    async def run(self) -> None:
        """Looks once a second, and once more at the end."""
        try:
            while True:
                await asyncio.sleep(LOOK_S)
                await self.look()
        finally:
            await self.look(at_the_end=True)

    async def look(self, *, at_the_end: bool = False) -> None:
        """Takes the new images that have stopped growing (at the end, all)."""
        try:
            present = self._present()
            new = {path: state for path, state in present.items() if self._done.get(path) != state}
            for path, state in sorted(new.items(), key=lambda item: (item[1], item[0])):
                if at_the_end or self._growing.get(path) == state:
                    await self._take(path)
                    self._done[path] = state
            self._growing = new
            self.trouble = None
        except OSError as error:
            self.trouble = f"{error.filename or self._folder}: {error.strerror}"

    async def _take(self, path: Path) -> None:
        content = await asyncio.to_thread(path.read_bytes)
        time_ns = exif.taken_ns(content)
        if time_ns is None:
            time_ns = path.stat().st_mtime_ns
        await self._keep(time_ns, content, ENDINGS[path.suffix.lower()])

    def _present(self) -> dict[Path, tuple[int, int]]:
        """Time of change and size of each image in the folder."""
        images = (path for path in self._folder.iterdir() if path.suffix.lower() in ENDINGS)
        states = ((path, path.stat()) for path in images if path.is_file())
        return {path: (state.st_mtime_ns, state.st_size) for path, state in states}
