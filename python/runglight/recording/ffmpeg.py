"""Photos from a camera, read by the program `ffmpeg`.

It runs beside us and is never linked (docs/decisions/0005-cameras-through-a-program.md).
"""

from __future__ import annotations

import asyncio
import time
from pathlib import Path
from urllib.parse import urlsplit

from runglight.recording.camera import Camera
from runglight.taps.clock import Clock

RETRY_S = 5.0
"""How long after a camera went away until it is tried again."""
ADDRESSES = ("rtsp://", "rtsps://", "http://", "https://")
_START, _END = b"\xff\xd8\xff", b"\xff\xd9"
_LARGEST_PHOTO_BYTES = 64 << 20


class FfmpegCamera(Camera):
    """A stream of JPEG images from ffmpeg; each is stamped when it arrives."""

    def __init__(
        self, program: str, source: str, recording: Path, clock: Clock, interval_s: float
    ) -> None:
        super().__init__(recording)
        self._program = program
        self._source = source
        self._shown = _without_password(source)
        self._clock = clock
        self._interval_ns = round(interval_s * 1e9)

    async def run(self) -> None:
        """Starts ffmpeg, and again whenever it ends."""
        while True:
            began = time.monotonic()
            try:
                self.trouble = await self._stream()
            except OSError as error:
                self.trouble = f"{self._shown}: {error.strerror}"
            await asyncio.sleep(max(RETRY_S - (time.monotonic() - began), 0.0))

    def _arguments(self) -> list[str]:
        quiet = ["-hide_banner", "-loglevel", "error", "-nostdin", "-fflags", "nobuffer"]
        network = self._source.startswith(ADDRESSES)
        if self._source.startswith("rtsp"):
            given = ["-rtsp_transport", "tcp", "-i", self._source]
        else:
            given = ["-i", self._source] if network else ["-f", "v4l2", "-i", self._source]
        return [*quiet, *given, "-an", "-c:v", "mjpeg", "-q:v", "4", "-f", "image2pipe", "pipe:1"]

    async def _stream(self) -> str:
        """Runs ffmpeg to its end; returns why it ended."""
        process = await asyncio.create_subprocess_exec(
            self._program,
            *self._arguments(),
            stdin=asyncio.subprocess.DEVNULL,
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.PIPE,
        )
        assert process.stdout is not None
        assert process.stderr is not None
        complaints = asyncio.create_task(process.stderr.read())
        try:
            await self._take_all(process.stdout)
            said = (await complaints).decode("utf-8", "replace").partition("\n")[0].strip()
            said = said.replace(self._source, self._shown) or "the camera sends no more"
            return said if self._shown in said else f"{self._shown}: {said}"
        finally:
            complaints.cancel()
            if process.returncode is None:
                process.kill()
            await process.wait()

    async def _take_all(self, stream: asyncio.StreamReader) -> None:
        next_ns = 0
        gathered = b""
        while content := await stream.read(1 << 16):
            gathered += content
            while (photo := _first_jpeg(gathered)) is not None:
                start, end = photo
                now_ns = self._clock.now_ns()
                if now_ns >= next_ns:
                    next_ns = now_ns + self._interval_ns
                    await self._keep(now_ns, gathered[start:end])
                    self.trouble = None
                gathered = gathered[end:]
            if len(gathered) > _LARGEST_PHOTO_BYTES:
                gathered = b""


def _without_password(source: str) -> str:
    if not source.startswith(ADDRESSES):
        return source
    parts = urlsplit(source)
    return parts._replace(netloc=parts.netloc.rpartition("@")[2]).geturl()


def _first_jpeg(content: bytes) -> tuple[int, int] | None:
    """Where the first whole JPEG lies. In its data FF is stuffed, so FFD9 is its end."""
    start = content.find(_START)
    end = -1 if start < 0 else content.find(_END, start)
    return None if end < 0 else (start, end + len(_END))
