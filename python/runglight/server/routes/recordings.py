"""Recordings and logs: the list, recording the live machine, uploads."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

import msgspec
from starlette.responses import Response
from starlette.routing import Route

from runglight.errors import InputError
from runglight.log.changelog import read_log_with
from runglight.recording.description import read_description
from runglight.server.answers import body_of, json_answer
from runglight.server.catalogue import LOG_ENDINGS, SOURCES, Item, free_name
from runglight.server.workshop_of import workshop_of

if TYPE_CHECKING:
    from pathlib import Path

    from starlette.requests import Request


class Named(msgspec.Struct):
    """What a recording shall be called."""

    name: str


class Listed(msgspec.Struct, frozen=True):
    """One recording or log in the list."""

    id: str
    name: str
    kind: str
    bytes: int
    changed_ms: float
    source: str | None
    signals: int | None
    recording: bool


async def get_recordings(request: Request) -> Response:
    """What was recorded or imported."""
    workshop = workshop_of(request)

    def look() -> list[Listed]:
        feed = workshop.live.feed
        recorder = None if feed is None else feed.recorder
        now = None if recorder is None else recorder.directory
        items = [item for item in workshop.catalogue.items() if item.kind in SOURCES]
        return [_listed(item, recording=item.path == now) for item in items]

    return json_answer(await asyncio.to_thread(look))


async def post_start(request: Request) -> Response:
    """Records the live machine from now on."""
    workshop = workshop_of(request)
    named = await body_of(request, Named)
    feed = workshop.live.feed
    if feed is None:
        raise InputError("no live source is watched; name one under [source] in the configuration")
    directory = free_name(workshop.directory, named.name or "recording", "")
    feed.record(directory, round(workshop.configuration.record.reserve_mb * 1e6))
    return json_answer({"name": directory.name})


async def post_stop(request: Request) -> Response:
    """Ends the recording."""
    feed = workshop_of(request).live.feed
    if feed is None or feed.recorder is None:
        raise InputError("nothing is being recorded")
    name, rows = feed.recorder.directory.name, feed.recorder.rows
    await asyncio.to_thread(feed.close)
    return json_answer({"name": name, "rows": rows})


async def post_upload(request: Request) -> Response:
    """Takes a log as the body, reads it to see that it is one, and keeps it.

    The name is for people; the ending says the format.
    """
    workshop = workshop_of(request)
    name = request.query_params.get("name", "upload.csv")
    stem, dot, ending = name.rpartition(".")
    if f"{dot}{ending}".lower() not in LOG_ENDINGS:
        raise InputError(f"{name}: is no log; upload one that ends in {', '.join(LOG_ENDINGS)}")
    target = free_name(workshop.directory, stem, f".{ending.lower()}")
    temporary = target.with_name(f".uploading-{target.name}")
    try:
        with temporary.open("wb") as stream:
            async for chunk in request.stream():
                await asyncio.to_thread(stream.write, chunk)
        log = await asyncio.to_thread(_read_upload, temporary, name, workshop.configuration.log)
        temporary.replace(target)
    finally:
        temporary.unlink(missing_ok=True)
    item = workshop.catalogue.of_path(target)
    return json_answer({"id": None if item is None else item.id, "name": target.name, **log})


def _read_upload(path: Path, name: str, options: object) -> dict[str, object]:
    try:
        log = read_log_with(path, options)  # type: ignore[arg-type]
    except InputError as error:
        # The user knows the file by the name it has on their computer.
        raise InputError(str(error).replace(str(path), name)) from None
    return {"rows": len(log), "signals": len(log.signals), "notes": log.report.notes}


def _listed(item: Item, *, recording: bool) -> Listed:
    source: str | None = None
    signals: int | None = None
    if item.kind == "recording":
        try:
            description = read_description(item.path)
            source, signals = description.source, len(description.signals)
        except InputError as error:
            source = str(error)
        files = [path for path in item.path.rglob("*") if path.is_file()]
    else:
        files = [item.path]
    stats = [path.stat() for path in files]
    return Listed(
        id=item.id,
        name=item.name,
        kind=item.kind,
        bytes=sum(stat.st_size for stat in stats),
        changed_ms=max((stat.st_mtime for stat in stats), default=0.0) * 1000,
        source=source,
        signals=signals,
        recording=recording,
    )


ROUTES = [
    Route("/api/recordings", get_recordings),
    Route("/api/recordings/start", post_start, methods=["POST"]),
    Route("/api/recordings/stop", post_stop, methods=["POST"]),
    Route("/api/uploads", post_upload, methods=["POST"]),
]
