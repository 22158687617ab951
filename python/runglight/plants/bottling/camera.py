"""A camera before the bottling machine: its photos have grain, and the light in the hall drifts."""

from __future__ import annotations

import io
from datetime import UTC, datetime
from math import sin, tau
from typing import TYPE_CHECKING

import numpy as np

from runglight.errors import InputError

if TYPE_CHECKING:
    from PIL import Image

    from runglight.plants.bottling.scene import Scene

GRAIN = 5.0
"""Standard deviation of a pixel's brightness from photo to photo, of 255."""

DRIFTS = ((0.10, 610.0), (0.05, 97.0), (0.02, 31.0))
"""The hall's light: sun, clouds, other machines; share of the brightness, and period in seconds."""

QUALITY = 85

_EXIF, _ORIGINAL, _OFFSET, _SUB_SECONDS = 0x8769, 0x9003, 0x9011, 0x9291


def photograph(scene: Scene, seed: int = 1) -> bytes:
    """A photo of the scene, JPEG; the moment stands in its EXIF, to the nanosecond.

    The same scene and seed give the same photo. InputError where Pillow is not installed.
    """
    try:
        from runglight.plants.bottling.picture import draw  # noqa: PLC0415
    except ModuleNotFoundError:
        raise InputError('photos need Pillow: pip install "runglight[vision]"') from None
    return _jpeg(_exposed(draw(scene), scene.time_ns, seed), scene.time_ns)


def _exposed(image: Image.Image, time_ns: int, seed: int) -> Image.Image:
    from PIL import Image  # noqa: PLC0415

    pixels = np.asarray(image, np.float32)
    height, width, _ = pixels.shape
    time_s = time_ns / 1e9
    light = 1.0 + sum(
        share * sin(tau * (time_s / period_s + 0.37 * place + 0.11 * seed))
        for place, (share, period_s) in enumerate(DRIFTS)
    )
    # The sun comes from the left at one time, from the right at another.
    lean = 0.05 * sin(tau * time_s / 430.0 + seed)
    across = light + lean * np.linspace(-1.0, 1.0, width, dtype=np.float32)
    grain = np.random.default_rng((seed, time_ns)).standard_normal((height, width), np.float32)
    seen = pixels * across[None, :, None] + GRAIN * grain[:, :, None]
    return Image.fromarray(np.clip(seen, 0, 255).astype(np.uint8))


def _jpeg(image: Image.Image, time_ns: int) -> bytes:
    from PIL import Image  # noqa: PLC0415

    seconds, nanoseconds = divmod(time_ns, 1_000_000_000)
    exif = Image.Exif()
    original = exif.get_ifd(_EXIF)
    original[_ORIGINAL] = f"{datetime.fromtimestamp(seconds, UTC):%Y:%m:%d %H:%M:%S}"
    original[_OFFSET] = "+00:00"
    original[_SUB_SECONDS] = f"{nanoseconds:09d}"
    content = io.BytesIO()
    image.save(content, "JPEG", quality=QUALITY, exif=exif)
    return content.getvalue()
