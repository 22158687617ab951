"""Which source shows what happened at a moment."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

from runglight.errors import RunglightError
from runglight.recording.layout import is_recording
from runglight.recording.read import open_recording

if TYPE_CHECKING:
    from pathlib import Path

    from runglight.server.workshop import Workshop

LIVE = "live"


async def source_around(workshop: Workshop, at_ns: int) -> str | None:
    """The id of the source that covers a moment: the live one, else a recording or log."""
    feed = workshop.live.feed
    if feed is not None and feed.start_ns is not None and feed.start_ns <= at_ns <= feed.until_ns:
        return LIVE
    items = await asyncio.to_thread(workshop.catalogue.items)
    for item in items:
        if item.kind == "recording" and await asyncio.to_thread(_covers, item.path, at_ns):
            return item.id
    for item in items:
        if item.kind != "log":
            continue
        try:
            diagram = await workshop.diagrams.of(item)
        except (RunglightError, OSError):
            continue
        if diagram.start_ns <= at_ns <= diagram.until_ns:
            return item.id
    return None


def _covers(path: Path, at_ns: int) -> bool:
    """Whether something was recorded around a moment; what lies elsewhere is not even opened."""
    if not is_recording(path):
        return False
    try:
        around = open_recording(path, at_ns - 1_000_000_000, at_ns + 1_000_000_000, scans=False)
    except (RunglightError, OSError):
        return False
    return around.until_ns >= at_ns
