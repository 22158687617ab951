import asyncio
import os
from collections.abc import Callable
from pathlib import Path

import pytest

from runglight.errors import InputError
from runglight.recording import camera as camera_module
from runglight.recording.camera import Camera, FfmpegCamera, ImageFolder, camera_of
from runglight.recording.photos import photos
from runglight.taps.clock import SteadyClock
from tests.recording.test_exif import MOMENT_NS, jpeg

HANGS_S = 60


def contents(recording: Path) -> list[bytes]:
    return [photo.path.read_bytes() for photo in photos(recording)]


@pytest.fixture
def folders(tmp_path: Path) -> tuple[Path, Path]:
    """A camera's folder with an image of yesterday, and a recording."""
    folder, recording = tmp_path / "camera", tmp_path / "recording"
    folder.mkdir()
    recording.mkdir()
    (folder / "yesterday.jpg").write_bytes(b"old")
    return folder, recording


def test_new_images_of_a_folder_are_copied_by_their_time(folders: tuple[Path, Path]) -> None:
    folder, recording = folders
    camera = ImageFolder(folder, recording)

    async def look() -> None:
        await camera.look()
        taken = jpeg({0x9003: "2026:01:31 06:00:12", 0x9011: "+00:00"})
        (folder / "a.JPG").write_bytes(taken)
        (folder / "b.png").write_bytes(b"no exif")
        os.utime(folder / "b.png", ns=(0, MOMENT_NS + 7))
        (folder / "notes.txt").write_text("no image")
        await camera.look()
        assert camera.taken == 0  # They may still be growing.
        await camera.look()
        await camera.look()
        assert camera.taken == 2

    asyncio.run(look())
    assert [photo.time_ns for photo in photos(recording)] == [MOMENT_NS, MOMENT_NS + 7]
    assert [photo.path.suffix for photo in photos(recording)] == [".jpg", ".png"]
    assert (folder / "a.JPG").exists()


def test_an_image_that_grows_is_taken_when_it_is_whole(folders: tuple[Path, Path]) -> None:
    folder, recording = folders
    camera = ImageFolder(folder, recording)

    async def look() -> None:
        for content in (b"h", b"half", b"half and whole"):
            (folder / "new.jpg").write_bytes(content)
            await camera.look()
        await camera.look()

    asyncio.run(look())
    assert contents(recording) == [b"half and whole"]


def test_the_last_image_is_taken_at_the_end(folders: tuple[Path, Path]) -> None:
    folder, recording = folders

    async def run() -> Camera:
        camera = ImageFolder(folder, recording)
        running = asyncio.create_task(camera.run())
        await asyncio.sleep(0)
        (folder / "new.jpg").write_bytes(b"new")
        running.cancel()
        await asyncio.gather(running, return_exceptions=True)
        return camera

    assert asyncio.run(run()).taken == 1
    assert contents(recording) == [b"new"]


def test_a_folder_that_goes_away_is_told_and_comes_back(folders: tuple[Path, Path]) -> None:
    folder, recording = folders
    camera = ImageFolder(folder, recording)
    aside = folder.with_name("aside")

    async def look() -> None:
        folder.rename(aside)
        await camera.look()
        assert camera.trouble is not None
        assert str(folder) in camera.trouble
        aside.rename(folder)
        await camera.look()
        assert camera.trouble is None

    asyncio.run(look())


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
    monkeypatch.setattr(camera_module, "RETRY_S", 0.01)
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


def test_what_cannot_be_a_camera_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(InputError, match="/dev/video77 is neither a folder nor a device"):
        camera_of("/dev/video77", tmp_path, SteadyClock())
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(InputError, match="needs the program ffmpeg, which is not installed: apt"):
        camera_of("rtsp://camera/1", tmp_path, SteadyClock())
    assert isinstance(camera_of(str(tmp_path), tmp_path, SteadyClock()), ImageFolder)
