"""How a rectangle looks in each photo: few coarse cells, freed from changes of light and camera.

A cloud, a lamp or the camera's own exposure changes the whole picture, and what happens in the
rectangle leaves the rest as it is. So every photo is brought to the usual brightness by what lies
outside of the rectangle, and moved back where the camera was shaken.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from runglight.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    import numpy.typing as npt

    from runglight.identification.rectangle import Rectangle
    from runglight.recording.photos import Photo

    Floats = npt.NDArray[np.float32]

CELLS = 24
"""The rectangle is averaged to at most this many cells each way: noise of pixels averages out."""
OVERVIEW_PX = 160
"""Width to which a whole photo is averaged, to see its light and where it was shaken to."""
MOST_SHAKEN = 0.02
"""Share of the photo's width; a larger shift is no shaking, but something that moves."""
DARK = 8
"""Below this brightness (of 255) a ratio of two photos tells nothing of their light."""


def looks(photos: Sequence[Photo], rectangle: Rectangle, advance: Callable[[int], None]) -> Floats:
    """Array (photo, row, column, colour), 0 to 255: the rectangle in each photo, coarsely.

    InputError where a photo cannot be read or is too small, or where pillow or scikit-image is
    not installed. `advance` is told of every photo looked at; each is looked at twice.
    """
    vision = _Vision()
    overviews = []
    for photo in photos:
        overviews.append(vision.overview(photo, rectangle))
        advance(1)
    usual = np.median(overviews, axis=0)
    outside = _outside(usual.shape, rectangle, vision.width, vision.height)
    seen = []
    for photo, overview in zip(photos, overviews, strict=True):
        moved = vision.shaken(usual, overview)
        light = _light(usual, overview, outside)
        seen.append(vision.look(photo, rectangle, moved) / light)
        advance(1)
    return np.asarray(seen, np.float32)


class _Vision:
    """What needs the libraries of the extra `vision`."""

    def __init__(self) -> None:
        try:
            from PIL import Image  # noqa: PLC0415
            from skimage import registration  # noqa: PLC0415
        except ModuleNotFoundError:
            raise InputError(
                'looking at photos needs pillow and scikit-image: pip install "runglight[vision]"'
            ) from None
        self._image = Image
        # scikit-image is not typed throughout.
        self._registration: Any = registration
        self.width = self.height = 0

    def overview(self, photo: Photo, rectangle: Rectangle) -> Floats:
        """The whole photo, small."""
        image = self._open(photo)
        if (self.width, self.height) == (0, 0):
            self.width, self.height = image.size
            rectangle.check_within(self.width, self.height, str(photo.path))
        if image.size != (self.width, self.height):
            raise InputError(
                f"{photo.path}: has {image.size[0]} x {image.size[1]} pixels, the photos before "
                f"{self.width} x {self.height}; take away those of another camera or setting"
            )
        width = min(OVERVIEW_PX, self.width)
        height = max(1, round(self.height * width / self.width))
        return np.asarray(image.resize((width, height), self._image.Resampling.BOX), np.float32)

    def shaken(self, usual: Floats, overview: Floats) -> tuple[int, int]:
        """Pixels of the photo by which it lies lower and further to the right than usual."""
        grey = [_structure(picture.mean(axis=2)) for picture in (usual, overview)]
        if min(grey[0].shape) < 8 or not all(picture.any() for picture in grey):
            return 0, 0
        shift, *_ = self._registration.phase_cross_correlation(
            *grey, upsample_factor=10, normalization=None
        )
        scale = self.width / usual.shape[1]
        down, right = -float(shift[0]) * scale, -float(shift[1]) * scale
        if max(abs(down), abs(right)) > MOST_SHAKEN * self.width:
            return 0, 0
        return round(down), round(right)

    def look(self, photo: Photo, rectangle: Rectangle, moved: tuple[int, int]) -> Floats:
        """The rectangle of one photo, in few cells."""
        left = min(max(rectangle.x + moved[1], 0), self.width - rectangle.width)
        top = min(max(rectangle.y + moved[0], 0), self.height - rectangle.height)
        part = self._open(photo).crop((left, top, left + rectangle.width, top + rectangle.height))
        cells = (min(CELLS, rectangle.width), min(CELLS, rectangle.height))
        return np.asarray(part.resize(cells, self._image.Resampling.BOX), np.float32)

    def _open(self, photo: Photo) -> Any:
        try:
            return self._image.open(photo.path).convert("RGB")
        except (OSError, ValueError, SyntaxError) as error:
            raise InputError(
                f"{photo.path}: cannot be read as a photo ({error}); move it out of the folder"
            ) from None


def _structure(picture: Floats) -> Floats:
    """Edges: what stays where it is in any light."""
    down, right = np.gradient(picture)
    edges = np.hypot(down, right)
    centred: Floats = edges - edges.mean()
    return centred


def _outside(
    shape: tuple[int, ...], rectangle: Rectangle, width: int, height: int
) -> npt.NDArray[np.bool_]:
    """The cells of an overview that the rectangle does not touch."""
    rows, columns = shape[:2]
    outside = np.ones((rows, columns), bool)
    outside[
        rectangle.y * rows // height : -(-(rectangle.y + rectangle.height) * rows // height),
        rectangle.x * columns // width : -(-(rectangle.x + rectangle.width) * columns // width),
    ] = False
    return outside


def _light(usual: Floats, overview: Floats, outside: npt.NDArray[np.bool_]) -> Floats:
    """How much brighter a photo is than usual, by colour."""
    light = np.ones(3, np.float32)
    for colour in range(3):
        usually, now = usual[..., colour][outside], overview[..., colour][outside]
        told = usually > DARK
        if told.sum() >= 16:
            light[colour] = max(0.1, float(np.median(now[told] / usually[told])))
    return light
