"""What puts photos beside the signals."""

from __future__ import annotations

import asyncio
from abc import ABC, abstractmethod
from pathlib import Path

from runglight.recording.photos import keep_photo


class Camera(ABC):
    """Puts photos into a recording until `run` is cancelled."""

    def __init__(self, recording: Path) -> None:
        self._recording = recording
        self.taken = 0
        """Photos so far."""
        self.trouble: str | None = None
        """One sentence where no photos come at the moment."""

    @abstractmethod
    async def run(self) -> None:
        """Takes photos until cancelled; what goes wrong is told in `trouble` and tried again."""

    async def _keep(self, time_ns: int, content: bytes, ending: str = ".jpg") -> None:
        await asyncio.to_thread(keep_photo, self._recording, time_ns, content, ending)
        self.taken += 1
