import asyncio
import os
from pathlib import Path

import pytest

from runglight.recording.camera import Camera
from runglight.recording.image_folder import ImageFolder
from runglight.recording.photos import photos
from tests.recording.test_exif import MOMENT_NS, jpeg


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
