"""Who is asking: the token once, then a cookie that scripts cannot read."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

import msgspec
from starlette.routing import Route

from runglight._engine import __version__
from runglight.server.answers import body_of, json_answer
from runglight.server.guard import COOKIE, cookie_of, refusal
from runglight.server.workshop_of import workshop_of

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.responses import Response

WRONG_TOKEN_S = 1.0
"""How long a wrong token waits for its answer."""


class Offered(msgspec.Struct):
    """A token."""

    token: str


async def get_session(request: Request) -> Response:
    """What the page must know before it asks for more."""
    policy = workshop_of(request).policy
    admitted = policy.token is None or policy.takes_session(cookie_of(request.headers))
    told: dict[str, object] = {"needs_token": not admitted}
    if admitted:
        told |= {
            "version": __version__,
            "read_only": policy.read_only,
            "upload_bytes": policy.upload_bytes,
        }
    return json_answer(told)


async def post_session(request: Request) -> Response:
    """Takes the token and gives a session for it."""
    policy = workshop_of(request).policy
    offered = await body_of(request, Offered)
    if policy.token is not None and not policy.takes_token(offered.token):
        await asyncio.sleep(WRONG_TOKEN_S)
        return refusal(401, "this is not the token; it stands where the server was started")
    answer = json_answer({"needs_token": False})
    answer.set_cookie(COOKIE, policy.session(), httponly=True, samesite="strict", path="/")
    return answer


ROUTES = [
    Route("/api/session", get_session),
    Route("/api/session", post_session, methods=["POST"]),
]
