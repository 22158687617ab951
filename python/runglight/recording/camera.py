"""Photos beside the signals: from a folder that fills with images, or from a camera.

A camera is read by the program `ffmpeg`, run beside us and never linked
(docs/decisions/0005-cameras-through-a-program.md).
"""

from __future__ import annotations

import asyncio
import shutil
import time
from abc import ABC, abstractmethod
from pathlib import Path

from runglight.errors import InputError
from runglight.recording import exif
from runglight.recording.photos import ENDINGS, keep_photo
from runglight.taps.clock import Clock

LOOK_S = 1.0
"""How often a folder is looked at."""
RETRY_S = 5.0
"""How long after a camera went away until it is tried again."""
_ADDRESSES = ("rtsp://", "rtsps://", "http://", "https://")
_START, _END = b"\xff\xd8\xff", b"\xff\xd9"
_LARGEST_PHOTO_BYTES = 64 << 20


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


def camera_of(source: str, recording: Path, clock: Clock, interval_s: float = 1.0) -> Camera:
    """The camera a user named: a folder, a device or an address; InputError where there is none."""
    if Path(source).is_dir():
        return ImageFolder(Path(source), recording)
    if not source.startswith(_ADDRESSES) and not Path(source).exists():
        raise InputError(
            f"--camera: {source} is neither a folder nor a device; name a folder of images, "
            "a device like /dev/video0, or an address like rtsp://HOST/STREAM"
        )
    program = shutil.which("ffmpeg")
    if program is None:
        raise InputError(
            f"--camera: {source} needs the program ffmpeg, which is not installed: "
            "apt install ffmpeg; a folder of images needs nothing"
        )
    return FfmpegCamera(program, source, recording, clock, interval_s)


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


class FfmpegCamera(Camera):
    """A stream of JPEG images from ffmpeg; each is stamped when it arrives."""

    def __init__(
        self, program: str, source: str, recording: Path, clock: Clock, interval_s: float
    ) -> None:
        super().__init__(recording)
        self._program = program
        self._source = source
        self._clock = clock
        self._interval_ns = round(interval_s * 1e9)

    async def run(self) -> None:
        """Starts ffmpeg, and again whenever it ends."""
        while True:
            began = time.monotonic()
            try:
                self.trouble = await self._stream()
            except OSError as error:
                self.trouble = f"{self._source}: {error.strerror}"
            await asyncio.sleep(max(RETRY_S - (time.monotonic() - began), 0.0))

    def _arguments(self) -> list[str]:
        quiet = ["-hide_banner", "-loglevel", "error", "-nostdin", "-fflags", "nobuffer"]
        network = self._source.startswith(_ADDRESSES)
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
            said = (await complaints).decode("utf-8", "replace").split("\n")
            return f"{self._source}: {said[0].strip() or 'the camera sends no more'}"
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


def _first_jpeg(content: bytes) -> tuple[int, int] | None:
    """Where the first whole JPEG lies. In its data FF is stuffed, so FFD9 is its end."""
    start = content.find(_START)
    end = -1 if start < 0 else content.find(_END, start)
    return None if end < 0 else (start, end + len(_END))
