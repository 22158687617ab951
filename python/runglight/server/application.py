"""The ASGI application: the guard, the API, the built page."""

from __future__ import annotations

from contextlib import asynccontextmanager
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.middleware.gzip import GZipMiddleware
from starlette.responses import FileResponse, HTMLResponse, Response
from starlette.routing import Mount, Route
from starlette.staticfiles import StaticFiles

from runglight.server.answers import HANDLERS
from runglight.server.guard import Guard, refusal
from runglight.server.routes import ROOMS

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from starlette.requests import Request
    from starlette.types import Scope

    from runglight.server.workshop import Workshop

NOT_BUILT = (
    "<!doctype html><title>runglight</title><p>The page is not built here; the API works. "
    "In a clone of the repository: <code>make page</code> (needs Node 20)."
)


def page_directory() -> Path:
    """Where the built page lies; in the wheel it is always there."""
    return Path(str(files("runglight.server"))) / "page"


class _Assets(StaticFiles):
    """Files whose names hold their content's hash: never asked for twice."""

    async def get_response(self, path: str, scope: Scope) -> Response:
        answer = await super().get_response(path, scope)
        answer.headers["cache-control"] = "public, max-age=31536000, immutable"
        return answer


def application(workshop: Workshop) -> Starlette:
    """Answers from a workshop, which is opened with the server and closed with it."""
    page = page_directory()

    @asynccontextmanager
    async def lifespan(_app: Starlette) -> AsyncIterator[None]:
        await workshop.open()
        try:
            yield
        finally:
            await workshop.close()

    async def index(_request: Request) -> Response:
        if not (page / "index.html").is_file():
            return HTMLResponse(NOT_BUILT, 503)
        return FileResponse(page / "index.html", headers={"cache-control": "no-cache"})

    async def nothing(_request: Request) -> Response:
        return refusal(404, "there is nothing at this address")

    app = Starlette(
        routes=[
            *(route for room in ROOMS for route in room),
            Route("/api/{rest:path}", nothing, methods=["GET", "POST", "PUT", "DELETE", "PATCH"]),
            Route("/", index),
            Mount("/assets", _Assets(directory=page / "assets", check_dir=False)),
            Route("/icon.svg", lambda _request: FileResponse(page / "icon.svg")),
        ],
        middleware=[
            Middleware(Guard, policy=workshop.policy),
            Middleware(GZipMiddleware, minimum_size=1000, compresslevel=5),
        ],
        exception_handlers=HANDLERS,
        lifespan=lifespan,
    )
    app.state.workshop = workshop
    return app
