"""Which address is it? Photos, declared events, the ranking, and a name that is accepted."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import msgspec
from starlette.responses import FileResponse, Response
from starlette.routing import Route

from runglight.errors import InputError
from runglight.identification.accepted import accept, found_in, type_in
from runglight.identification.identify import Order, View, identify_in
from runglight.identification.proposal import By, propose_events
from runglight.identification.rectangle import Rectangle
from runglight.identification.sweep import sweep_in
from runglight.identification.verdict import verdict
from runglight.moments import iso
from runglight.quantities import duration_s
from runglight.recording.layout import PHOTOS
from runglight.recording.photos import ENDINGS, name_of, photos
from runglight.server import declared
from runglight.server.answers import body_of, json_answer
from runglight.server.declared import Event
from runglight.server.guard import refusal
from runglight.server.routes.setup import symbols_path
from runglight.server.workshop_of import workshop_of

if TYPE_CHECKING:
    from starlette.requests import Request

    from runglight.recording.photos import Photo
    from runglight.server.catalogue import Item
    from runglight.server.subjects import Searched
    from runglight.server.workshop import Workshop

LONGEST_TAU_S = 3600.0
MOST_ROWS = 200
MOST_PHOTOS = 5_000
"""That are looked at for a proposal: each keeps its share of memory until all are compared."""
USUAL_TAU_S = 4.0
MEDIA_TYPES = {".jpg": "image/jpeg", ".png": "image/png"}
# The name of a photo is its time: what is at an address stays what it is.
FOR_EVER = "private, max-age=604800, immutable"
_looking = asyncio.Lock()


class Found(msgspec.Struct, frozen=True):
    """A recording or log in the list."""

    id: str
    name: str
    photos: int
    events: bool


class Asked(msgspec.Struct):
    """Declared events of a source, and which of its changes count."""

    source: str
    events: list[Event]
    view: View = "all"


class Ranking(Asked, kw_only=True):
    """What the table shall be ranked by."""

    tau_s: Annotated[float, msgspec.Meta(ge=0, le=LONGEST_TAU_S)]
    order: Order = "scores"
    rows: Annotated[int, msgspec.Meta(ge=1, le=MOST_ROWS)] = 50


class Drawn(msgspec.Struct):
    """A rectangle of the photos, in their pixels."""

    source: str
    x: Annotated[int, msgspec.Meta(ge=0, le=100_000)]
    y: Annotated[int, msgspec.Meta(ge=0, le=100_000)]
    width: Annotated[int, msgspec.Meta(ge=1, le=100_000)]
    height: Annotated[int, msgspec.Meta(ge=1, le=100_000)]
    by: By = "look"


class Kept(msgspec.Struct):
    """Events to be kept, and the version of the file that they are to replace."""

    source: str
    events: list[Event]
    version: str | None


class Named(msgspec.Struct):
    """An address, and what it shall be called."""

    source: str
    address: Annotated[str, msgspec.Meta(max_length=300)]
    name: Annotated[str, msgspec.Meta(max_length=300)]


@dataclass(frozen=True, slots=True)
class Opened:
    """A recording or log that is searched."""

    item: Item
    searched: Searched
    origin_ns: int


async def opened(workshop: Workshop, source_id: str) -> Opened:
    """InputError where there is none of this id, or it cannot be read."""
    item = workshop.catalogue.item(source_id, "recording", "log")
    searched = await workshop.subjects.of(item)
    origin_ns = searched.subject.log.engine.start_ns
    if origin_ns is None:
        raise InputError(f"{item.name}: holds no changes; record the machine while it works")
    return Opened(item, searched, origin_ns)


async def get_list(request: Request) -> Response:
    """What can be searched, and where there are photos."""
    workshop = workshop_of(request)

    def look() -> list[Found]:
        items = [item for item in workshop.catalogue.items() if item.kind in {"recording", "log"}]
        return [
            Found(item.id, item.name, len(_photos(item)), declared.file_of(item).is_file())
            for item in items
        ]

    return json_answer(await asyncio.to_thread(look))


async def get_one(request: Request) -> Response:
    """One source: its photos, what was declared, and what the set-up says."""
    workshop = workshop_of(request)
    one = await opened(workshop, request.path_params["source"])
    item, log = one.item, one.searched.subject.log
    settings = workshop.configuration.identify
    date = workshop.configuration.log.date or iso(one.origin_ns)[:10]
    try:
        tau_s = duration_s(settings.tau, "tau")
    except InputError:
        # `sweep` is no duration: the page has a button for it.
        tau_s = USUAL_TAU_S

    def look() -> dict[str, object]:
        taken = [photo.time_ns - one.origin_ns for photo in _photos(item)]
        end_ns = max(log.engine.end_ns or 0, one.origin_ns)
        try:
            found = declared.read(item, one.origin_ns, date)
            wrong = None
        except InputError as error:
            # Whatever is wrong with it: the photos can be looked at.
            path = declared.file_of(item)
            found = declared.Declared(path.name, [], declared.version_of(path))
            wrong = str(error).replace(str(path), path.name)
        return {
            "id": item.id,
            "name": item.name,
            "origin_ns": str(one.origin_ns),
            "length_ns": end_ns - one.origin_ns,
            "photos": taken,
            "declared": found,
            "declared_error": wrong,
            "tau_s": min(tau_s, LONGEST_TAU_S),
            "view": settings.view,
            "order": settings.order,
            "naming": workshop.configuration.symbols.naming,
            "table": symbols_path(workshop).name,
        }

    return json_answer(await asyncio.to_thread(look))


async def get_photo(request: Request) -> Response:
    """The bytes of one photo, asked for by its time; nothing else of the recording."""
    workshop = workshop_of(request)
    item = workshop.catalogue.item(request.path_params["source"], "recording")
    time_ns = request.path_params["time"]
    for ending in dict.fromkeys(ENDINGS.values()):
        try:
            path = item.path / PHOTOS / name_of(time_ns, ending)
        except OverflowError:
            break
        if path.is_file():
            headers = {"cache-control": FOR_EVER, "content-encoding": "identity"}
            return FileResponse(path, media_type=MEDIA_TYPES[ending], headers=headers)
    return refusal(404, "there is no photo of this moment; load the page again")


async def post_ranking(request: Request) -> Response:
    """The table for some events and a τ."""
    workshop = workshop_of(request)
    asked = await body_of(request, Ranking)
    one = await opened(workshop, asked.source)
    events = declared.of(asked.events, one.origin_ns)

    def rank() -> dict[str, object]:
        symbols = workshop.configuration.symbols
        subject = one.searched.named(symbols_path(workshop), symbols.naming)
        settings = workshop.configuration.identify
        found = identify_in(
            subject,
            events,
            tau_s=asked.tau_s,
            view=asked.view,
            share=settings.share,
            words=settings.words,
            order=asked.order,
        )
        return {
            "windows": [
                (window.start_ns - one.origin_ns, window.end_ns - one.origin_ns, window.events)
                for window in found.windows
            ],
            "unrecorded": [time_ns - one.origin_ns for time_ns in found.unrecorded_ns],
            "changing": found.changing,
            "kept": len(found),
            "candidates": found.best(asked.rows),
            "verdict": verdict(found),
        }

    return json_answer(await asyncio.to_thread(rank))


async def post_sweep(request: Request) -> Response:
    """Which τ is suggested, and why."""
    workshop = workshop_of(request)
    asked = await body_of(request, Asked)
    one = await opened(workshop, asked.source)
    events = declared.of(asked.events, one.origin_ns)
    words = workshop.configuration.identify.words
    sweep = await asyncio.to_thread(
        sweep_in, one.searched.subject, events, view=asked.view, words=words
    )
    return json_answer(
        {
            "tau_s": sweep.tau_s,
            "reason": sweep.reason(),
            "steps": [(step.tau_s, step.met, step.windows) for step in sweep.steps],
        }
    )


async def post_proposal(request: Request) -> Response:
    """Events taken from the photos, where a rectangle of them changes. Keeps nothing."""
    workshop = workshop_of(request)
    drawn = await body_of(request, Drawn)
    item = workshop.catalogue.item(drawn.source, "recording", "log")
    if item.kind != "recording":
        raise InputError(f"{item.name} is no recording, so has no photos")
    one = await opened(workshop, drawn.source)
    if (taken := len(_photos(item))) > MOST_PHOTOS:
        raise InputError(
            f"{item.name} has {taken:,} photos, more than the {MOST_PHOTOS:,} that are looked at "
            "here; take them from the command line: runglight identify --propose"
        )
    rectangle = Rectangle(drawn.x, drawn.y, drawn.width, drawn.height)
    if _looking.locked():
        raise InputError("photos are being looked at already; wait until that is done")
    async with _looking:
        try:
            found = await asyncio.to_thread(propose_events, item.path, rectangle, by=drawn.by)
        except InputError as error:
            raise InputError(str(error).replace(str(item.path), item.name)) from None
    labels = [label or "" for label in found.labels]
    times = (found.time_ns - one.origin_ns).tolist()
    return json_answer({"events": list(map(Event, times, labels))})


async def post_events(request: Request) -> Response:
    """Keeps declared events in the recording, or beside the log."""
    workshop = workshop_of(request)
    kept = await body_of(request, Kept)
    one = await opened(workshop, kept.source)
    version = await asyncio.to_thread(
        declared.write, one.item, one.origin_ns, kept.events, kept.version
    )
    return json_answer({"file": declared.file_of(one.item).name, "version": version})


async def post_accept(request: Request) -> Response:
    """Writes a name into the symbol table, and begins anew with it."""
    workshop = workshop_of(request)
    named = await body_of(request, Named)
    one = await opened(workshop, named.source)
    table, naming = symbols_path(workshop), workshop.configuration.symbols.naming

    def write() -> dict[str, object]:
        subject = one.searched.subject
        signal, bit = found_in(subject, named.address, "address")
        kind = type_in(subject, signal, bit)
        try:
            before = accept(table, named.address, named.name.strip(), naming, kind, "name")
        except InputError as error:
            raise InputError(str(error).replace(str(table), table.name)) from None
        word = signal if bit is not None else None
        return {"table": table.name, "before": before, "word": word}

    told = await asyncio.to_thread(write)
    await workshop.reopen()
    return json_answer(told)


def _photos(item: Item) -> list[Photo]:
    return photos(item.path) if item.kind == "recording" else []


ROUTES = [
    Route("/api/identify", get_list),
    Route("/api/identify/ranking", post_ranking, methods=["POST"]),
    Route("/api/identify/sweep", post_sweep, methods=["POST"]),
    Route("/api/identify/proposal", post_proposal, methods=["POST"]),
    Route("/api/identify/events", post_events, methods=["POST"]),
    Route("/api/identify/accept", post_accept, methods=["POST"]),
    Route("/api/identify/{source}", get_one),
    Route("/api/identify/{source}/photos/{time:int}", get_photo),
]
