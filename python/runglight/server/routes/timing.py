"""Timing diagrams: of the live machine, of recordings and of logs."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass
from typing import TYPE_CHECKING

import msgspec
from starlette.responses import Response
from starlette.routing import Route

from runglight.errors import InputError
from runglight.server.answers import json_answer, number_of
from runglight.server.catalogue import SOURCES
from runglight.server.window import MEDIA_TYPE, window_bytes
from runglight.server.workshop_of import workshop_of

if TYPE_CHECKING:
    from starlette.requests import Request

    from runglight import _engine
    from runglight.server.places import Place
    from runglight.server.workshop import Workshop

LIVE = "live"
SEARCHED = ".searched"
"""After an id: what identification searches, signals by address and every bit of every word."""
MOST_COLUMNS = 20_000
MOST_LANES = 500


class Signal(msgspec.Struct, frozen=True):
    """One lane."""

    lane: int
    name: str
    group: str
    device: str
    signal: str
    address: str
    description: str
    type: str
    changes: int
    low: int
    high: int


@dataclass(frozen=True, slots=True)
class Source:
    """What is drawn; `origin_ns` is what the page counts from."""

    id: str
    name: str
    diagram: _engine.TimingDiagram
    places: list[Place]
    origin_ns: int
    until_ns: int
    gaps: list[tuple[int, int]]


async def source_of(workshop: Workshop, source_id: str) -> Source:
    """The source of an id; InputError where there is none, or it cannot be read."""
    if source_id == LIVE:
        feed = workshop.live.feed
        if feed is None or feed.start_ns is None:
            raise InputError("nothing has come from the machine yet; check the connection")
        places = workshop.live_signals()
        # The page keeps its place while the oldest minutes are forgotten.
        return Source(LIVE, "live", feed.diagram, places, 0, feed.until_ns, feed.gaps)
    item = workshop.catalogue.item(source_id.removesuffix(SEARCHED), "recording", "log")
    if source_id.endswith(SEARCHED):
        diagram = await asyncio.to_thread((await workshop.subjects.of(item)).diagram)
    else:
        diagram = await workshop.diagrams.of(item)
    places = workshop.log_signals(diagram.signals, diagram.addresses)
    return Source(
        source_id,
        item.name,
        diagram.diagram,
        places,
        diagram.start_ns,
        diagram.until_ns,
        diagram.gaps,
    )


async def get_sources(request: Request) -> Response:
    """What can be drawn."""
    workshop = workshop_of(request)
    feed = workshop.live.feed
    found = [{"id": LIVE, "name": "live", "kind": "live"}] if feed is not None else []
    items = await asyncio.to_thread(workshop.catalogue.items)
    found += [
        {"id": item.id, "name": item.name, "kind": item.kind}
        for item in items
        if item.kind in SOURCES
    ]
    return json_answer(found)


async def get_source(request: Request) -> Response:
    """The signals and the extent of one source."""
    source = await source_of(workshop_of(request), request.path_params["source"])
    start_ns = source.origin_ns
    if source.id == LIVE:
        feed = workshop_of(request).live.feed
        start_ns = (feed.start_ns if feed is not None else None) or 0
    return json_answer(
        {
            "id": source.id,
            "name": source.name,
            "origin_ns": str(start_ns),
            "length_ns": source.until_ns - start_ns,
            "gaps": [(start - start_ns, end - start_ns) for start, end in source.gaps],
            "signals": [_signal(source, lane) for lane in range(len(source.places))],
        }
    )


async def get_window(request: Request) -> Response:
    """Spans to draw, packed as `window` says; `from` and `until` count from `origin`."""
    source = await source_of(workshop_of(request), request.path_params["source"])
    origin_ns = number_of(request, "origin")
    from_ns = origin_ns + number_of(request, "from")
    until_ns = origin_ns + number_of(request, "until")
    columns = number_of(request, "columns", 1000)
    if not 1 <= columns <= MOST_COLUMNS:
        raise InputError(f"columns: expected 1 to {MOST_COLUMNS:,}, found {columns}")
    body = await asyncio.to_thread(
        window_bytes,
        source.diagram,
        _lanes(request),
        origin_ns=origin_ns,
        from_ns=from_ns,
        until_ns=until_ns,
        columns=columns,
    )
    answer = Response(body, media_type=MEDIA_TYPE)
    answer.headers["x-until"] = str(source.until_ns - origin_ns)
    return answer


async def get_edge(request: Request) -> Response:
    """The next change (`direction` 1) or the one before (-1) of any of the lanes."""
    source = await source_of(workshop_of(request), request.path_params["source"])
    origin_ns = number_of(request, "origin")
    at_ns = origin_ns + number_of(request, "at")
    forward = number_of(request, "direction", 1) > 0
    diagram = source.diagram
    found = [
        (edge, lane)
        for lane in _lanes(request)
        if (edge := (diagram.next_edge if forward else diagram.previous_edge)(lane, at_ns))
    ]
    if not found:
        return json_answer(None)
    (time_ns, value), lane = (min if forward else max)(found, key=lambda each: each[0][0])
    return json_answer({"at": time_ns - origin_ns, "value": value, "lane": lane})


def _lanes(request: Request) -> list[int]:
    texts = [text for text in request.query_params.get("lanes", "").split(",") if text]
    if len(texts) > MOST_LANES or not all(text.isdecimal() and len(text) < 8 for text in texts):
        raise InputError(f"lanes: expected up to {MOST_LANES} numbers with commas between them")
    return [int(text) for text in texts]


def _signal(source: Source, lane: int) -> Signal:
    place = source.places[lane]
    low, high = source.diagram.value_range(lane) or (0, 0)
    return Signal(
        lane=lane,
        name=place.name,
        group=place.group,
        device=place.device,
        signal=place.signal,
        address=place.address,
        description=place.description,
        type=place.type,
        changes=source.diagram.changes(lane),
        low=low,
        high=high,
    )


ROUTES = [
    Route("/api/sources", get_sources),
    Route("/api/sources/{source}", get_source),
    Route("/api/sources/{source}/window", get_window),
    Route("/api/sources/{source}/edge", get_edge),
]
