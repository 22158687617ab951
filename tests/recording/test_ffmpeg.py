import asyncio
import os
from collections.abc import Callable
from pathlib import Path

import pytest

from runglight.recording import ffmpeg as ffmpeg_module
from runglight.recording.cameras import camera_of
from runglight.recording.ffmpeg import FfmpegCamera
from runglight.recording.photos import photos
from runglight.taps.clock import SteadyClock

HANGS_S = 60


def contents(recording: Path) -> list[bytes]:
    return [photo.path.read_bytes() for photo in photos(recording)]


def photo(number: int) -> bytes:
    return b"\xff\xd8\xff\xe0" + bytes([number]) * 100_000 + b"\xff\xd9"


def program(tmp_path: Path, script: str) -> Path:
    """A stand-in for ffmpeg, which the tests cannot count on."""
    path = tmp_path / "bin" / "ffmpeg"
    path.parent.mkdir(exist_ok=True)
    path.write_text(f"#!/bin/sh\n{script}\n")
    path.chmod(0o755)
    return path


async def eventually(true: Callable[[], bool]) -> None:
    async with asyncio.timeout(HANGS_S):
        while not true():
            await asyncio.sleep(0.01)


@pytest.mark.parametrize("interval_s", [0.0, 3600.0])
def test_photos_of_a_camera(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, interval_s: float
) -> None:
    (tmp_path / "stream").write_bytes(b"junk" + b"".join(map(photo, range(3))) + photo(9)[:-2])
    script = f'echo "$@" > {tmp_path}/arguments; cat {tmp_path}/stream; exec sleep 60'
    monkeypatch.setenv("PATH", f"{program(tmp_path, script).parent}:{os.environ['PATH']}")
    expected = [photo(0), photo(1), photo(2)] if interval_s == 0 else [photo(0)]

    async def run() -> None:
        clock = SteadyClock()
        before_ns = clock.now_ns()
        camera = camera_of("/dev/null", tmp_path, clock, interval_s)
        running = asyncio.create_task(camera.run())
        await eventually(lambda: camera.taken == len(expected))
        running.cancel()
        await asyncio.gather(running, return_exceptions=True)
        for each in photos(tmp_path):
            assert before_ns <= each.time_ns <= clock.now_ns() + 10**7

    asyncio.run(run())
    assert contents(tmp_path) == expected
    arguments = (tmp_path / "arguments").read_text().split()
    assert arguments[-1] == "pipe:1"
    assert arguments[arguments.index("-i") + 1] == "/dev/null"


def test_a_camera_that_goes_away_is_told_and_tried_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ffmpeg_module, "RETRY_S", 0.01)
    (tmp_path / "stream").write_bytes(photo(1))
    script = (
        f"if [ -e {tmp_path}/back ]; then cat {tmp_path}/stream; exec sleep 60; fi\n"
        "echo '/dev/video7: No such device' >&2; exit 1"
    )

    async def run() -> None:
        ffmpeg = str(program(tmp_path, script))
        camera = FfmpegCamera(ffmpeg, "/dev/video7", tmp_path, SteadyClock(), 1.0)
        running = asyncio.create_task(camera.run())
        await eventually(lambda: camera.trouble is not None)
        assert camera.trouble == "/dev/video7: No such device"
        (tmp_path / "back").touch()
        await eventually(lambda: camera.taken == 1)
        assert camera.trouble is None
        running.cancel()
        await asyncio.gather(running, return_exceptions=True)

    asyncio.run(run())


def test_a_cameras_password_is_shown_to_nobody(tmp_path: Path) -> None:
    async def run() -> None:
        ffmpeg = str(program(tmp_path, 'echo "$*: 401 Unauthorized" >&2'))
        source = "rtsp://admin:secret@camera/1"
        camera = FfmpegCamera(ffmpeg, source, tmp_path, SteadyClock(), 1.0)
        running = asyncio.create_task(camera.run())
        await eventually(lambda: camera.trouble is not None)
        running.cancel()
        await asyncio.gather(running, return_exceptions=True)
        assert camera.trouble is not None
        assert "401" in camera.trouble
        assert "rtsp://camera/1" in camera.trouble
        assert "secret" not in camera.trouble

    asyncio.run(run())
