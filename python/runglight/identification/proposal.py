"""Events proposed from a recording's photos: the moments at which a rectangle of them changes.

By `look`: the rectangle has a usual look (that of most photos). An event is when it comes away
from it (label `away`: a part appears, a lamp goes on) and when it is `back`.

By `motion`: an event is when what is in the rectangle begins to move (label `starts`) and when it
stands again (`stops`), for belts that never look alike twice.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from runglight.errors import InputError
from runglight.identification.events import Events
from runglight.identification.looks import looks
from runglight.identification.rectangle import Rectangle
from runglight.recording.photos import photos as photos_of

if TYPE_CHECKING:
    from collections.abc import Callable
    from os import PathLike

    import numpy.typing as npt

    Floats = npt.NDArray[np.float32]
    Flags = npt.NDArray[np.bool_]

By = Literal["look", "motion"]

FEWEST_PHOTOS = 5
BUSIEST = 0.25
"""Share of the rectangle's cells that count, those that differ most: a part need not fill it."""
LEAST_DIFFERENCE = 6.0
"""Of 255: differences below are noise of the camera whatever its other photos are like."""
CLEAR = 3.0
"""Photos that differ must do so by this many times the noise of those that do not."""
HOLE = 5
"""Photos this many times the usual time apart leave open when something happened."""


def propose_events(
    recording: str | PathLike[str],
    rectangle: Rectangle | tuple[int, int, int, int],
    *,
    by: By = "look",
    advance: Callable[[int], None] = lambda _done: None,
) -> Events:
    """Proposes events from the photos of a recording.

    `rectangle` is (x, y, width, height) in pixels from the upper left corner. A moment is the
    middle between the two photos around it. `advance` is told of progress: two for each photo.
    InputError for fewer than five photos, a rectangle outside of them, or a missing extra.
    """
    if not isinstance(rectangle, Rectangle):
        rectangle = Rectangle.parse(",".join(map(str, rectangle)), "rectangle")
    taken = photos_of(Path(recording))
    if len(taken) < FEWEST_PHOTOS:
        raise InputError(
            f"{recording}: has {len(taken)} photos, and {FEWEST_PHOTOS} are the least to see a "
            "change in; record with --camera"
        )
    times = np.array([photo.time_ns for photo in taken], np.int64)
    seen = looks(taken, rectangle, advance)
    if by == "look":
        return _changes(times, _differing(_distances(seen, np.median(seen, axis=0))))
    return _motions(times, _differing(_distances(seen[1:], seen[:-1])))


def _distances(seen: Floats, others: Floats) -> Floats:
    """How much each photo differs, 0 to 255, in the cells that differ most."""
    by_cell = np.sqrt(((seen - others) ** 2).mean(axis=-1)).reshape(len(seen), -1)
    busiest = max(1, round(by_cell.shape[1] * BUSIEST))
    distances: Floats = np.sort(by_cell, axis=1)[:, -busiest:].mean(axis=1)
    return distances


def _differing(distances: Floats) -> Flags:
    """Which photos differ: none where they do not fall clearly into two kinds."""
    from skimage import filters  # noqa: PLC0415

    # scikit-image is not typed throughout.
    thresholds: Any = filters
    none = np.zeros(len(distances), bool)
    if distances.max() - distances.min() < LEAST_DIFFERENCE:
        return none
    threshold = float(thresholds.threshold_otsu(distances))
    alike, different = distances[distances <= threshold], distances[distances > threshold]
    if not len(alike) or not len(different):
        return none
    low, high = float(np.median(alike)), float(np.median(different))
    noise = float(np.median(np.abs(alike - low)))
    if high - low < max(LEAST_DIFFERENCE, CLEAR * noise):
        return none
    # A photo in doubt goes with its neighbours.
    differing: Flags = thresholds.apply_hysteresis_threshold(
        distances, threshold - (threshold - low) / 4, threshold + (high - threshold) / 4
    )
    return differing


def _changes(times: npt.NDArray[np.int64], away: Flags) -> Events:
    steps = np.diff(away.astype(np.int8))
    certain = np.diff(times) <= HOLE * np.median(np.diff(times))
    at = np.flatnonzero((steps != 0) & certain)
    labels = tuple("away" if steps[each] > 0 else "back" for each in at.tolist())
    return Events(_middle(times, at), labels)


def _motions(times: npt.NDArray[np.int64], moving: Flags) -> Events:
    """`moving[k]` is what happened between photos k and k + 1."""
    filled = moving.copy()
    # A belt may look alike by chance in two photos.
    filled[1:-1] |= moving[:-2] & moving[2:]
    edges = np.diff(np.concatenate([[False], filled, [False]]).astype(np.int8))
    starts, stops = np.flatnonzero(edges > 0), np.flatnonzero(edges < 0) - 1
    told: list[tuple[int, str]] = []
    for start, stop in zip(starts.tolist(), stops.tolist(), strict=True):
        # A single difference is a change of look, no motion.
        if stop > start:
            told += [(start, "starts")] if start > 0 else []
            told += [(stop, "stops")] if stop < len(filled) - 1 else []
    at = np.array([place for place, _ in told], np.int64)
    return Events(_middle(times, at), tuple(label for _, label in told))


def _middle(times: npt.NDArray[np.int64], at: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    return times[at] + (times[at + 1] - times[at]) // 2
