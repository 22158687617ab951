"""The live view: everything once, then what changes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from starlette.responses import StreamingResponse
from starlette.routing import Route

from runglight.server.answers import json_answer
from runglight.server.workshop_of import workshop_of

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.responses import Response

    from runglight.server.workshop import Workshop


def live_picture(workshop: Workshop) -> dict[str, object]:
    """Everything the live view shows."""
    return {
        **workshop.status(),
        "model": None
        if workshop.model_item is None
        else {"id": workshop.model_item.id, "name": workshop.model_item.name},
        "groups": workshop.lights(),
        "incidents": workshop.incidents.summaries(),
        "notes": workshop.notes,
    }


async def get_live(request: Request) -> Response:
    """As it is now."""
    return json_answer(live_picture(workshop_of(request)))


async def get_stream(request: Request) -> Response:
    """Events: `hello` (everything), `status`, `lights`, `incidents`, `note`, `resync`."""
    workshop = workshop_of(request)
    return StreamingResponse(
        workshop.hub.subscribe(live_picture(workshop)), media_type="text/event-stream"
    )


ROUTES = [Route("/api/live", get_live), Route("/api/live/stream", get_stream)]
