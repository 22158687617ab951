from pathlib import Path

import pytest

from runglight.errors import InputError
from runglight.recording.cameras import camera_of
from runglight.recording.image_folder import ImageFolder
from runglight.taps.clock import SteadyClock


def test_what_cannot_be_a_camera_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(InputError, match="/dev/video77 is neither a folder nor a device"):
        camera_of("/dev/video77", tmp_path, SteadyClock())
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(InputError, match="needs the program ffmpeg, which is not installed: apt"):
        camera_of("rtsp://camera/1", tmp_path, SteadyClock())
    assert isinstance(camera_of(str(tmp_path), tmp_path, SteadyClock()), ImageFolder)
