"""When a plant's rows begin: every part must know, whichever part the first row is of."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple


class Opening(NamedTuple):
    """The first time of some rows, and whether they may be an image of the plant.

    The rows of a log's very first time tell how the plant stands, where any of them is 0.
    """

    time_ns: int
    image: bool


def earliest(openings: Iterable[Opening | None]) -> Opening | None:
    """Of several tasks and batches: the first time, and whether any row of it is 0."""
    known = [opening for opening in openings if opening is not None]
    if not known:
        return None
    first = min(opening.time_ns for opening in known)
    return Opening(first, any(opening.image for opening in known if opening.time_ns == first))
