"""The HTTP API, one file per room of the page; a new view adds its file and its line in `ROOMS`."""

from typing import TYPE_CHECKING

from runglight.server.routes import (
    identify,
    incidents,
    live,
    models,
    recordings,
    session,
    setup,
    timing,
)
from runglight.server.routes import process as process_room

if TYPE_CHECKING:
    from starlette.routing import Route

ROOMS: "list[list[Route]]" = [
    session.ROUTES,
    live.ROUTES,
    incidents.ROUTES,
    timing.ROUTES,
    models.ROUTES,
    identify.ROUTES,
    recordings.ROUTES,
    setup.ROUTES,
    process_room.ROUTES,
]
