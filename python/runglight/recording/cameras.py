"""The cameras there are, by what a user names."""

from __future__ import annotations

import shutil
from pathlib import Path

from runglight.errors import InputError
from runglight.recording.camera import Camera
from runglight.recording.ffmpeg import ADDRESSES, FfmpegCamera
from runglight.recording.image_folder import ImageFolder
from runglight.taps.clock import Clock


def camera_of(source: str, recording: Path, clock: Clock, interval_s: float = 1.0) -> Camera:
    """The camera a user named: a folder, a device or an address; InputError where there is none."""
    if Path(source).is_dir():
        return ImageFolder(Path(source), recording)
    if not source.startswith(ADDRESSES) and not Path(source).exists():
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
