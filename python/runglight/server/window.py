"""A window of a timing diagram as it goes over the line.

Little-endian, columns one after the other, so that the page can lay typed arrays over it:
`float64` origin-relative start of every span in nanoseconds, `float64` value, `uint32` changes,
`uint32` spans per lane, `uint8` whether the value is known. A head of four `uint32` comes first:
version, lanes, spans, 0.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from runglight import _engine

VERSION = 1
MEDIA_TYPE = "application/octet-stream"


def window_bytes(
    diagram: _engine.TimingDiagram,
    lanes: Sequence[int],
    *,
    origin_ns: int,
    from_ns: int,
    until_ns: int,
    columns: int,
) -> bytes:
    """The spans of some lanes; times relative to `origin_ns`, exact for a hundred days."""
    counts, start_ns, value, changes, known = diagram.spans(lanes, from_ns, until_ns, columns)
    head = np.array([VERSION, len(counts), len(start_ns), 0], "<u4")
    return b"".join(
        (
            head.tobytes(),
            (start_ns - origin_ns).astype("<f8").tobytes(),
            value.astype("<f8").tobytes(),
            changes.astype("<u4").tobytes(),
            counts.astype("<u4").tobytes(),
            known.tobytes(),
        )
    )
