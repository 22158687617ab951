"""What every request passes before it is answered.

Whom it asks for, where it comes from, and how much it brings. Answers leave with the headers that
keep a browser from doing more than it should.
"""

from __future__ import annotations

from http.cookies import CookieError, SimpleCookie
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import JSONResponse

if TYPE_CHECKING:
    from starlette.types import ASGIApp, Message, Receive, Scope, Send

    from runglight.server.policy import Policy

COMMAND_HEADER = "x-runglight"
"""A form, an image or a link of somebody else's page cannot send a header of its own."""
COOKIE = "runglight"
SESSION_PATH = "/api/session"
UPLOAD_PATH = "/api/uploads"
QUESTION_PATHS = frozenset(
    {"/api/identify/ranking", "/api/identify/sweep", "/api/identify/proposal"}
)
"""Posted because they are too long for an address; they change nothing, also for readers."""
COMMAND_BYTES = 4_000_000
"""Largest body of what is no upload: symbol tables are the longest."""

PAGE_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
    "connect-src 'self'; worker-src 'self'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'"
)
# Graphviz is WebAssembly. Only its worker may compile any, and it may load nothing.
WORKER_POLICY = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'"
_HEADERS = {
    "x-content-type-options": "nosniff",
    "x-frame-options": "DENY",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "permissions-policy": "camera=(), geolocation=(), microphone=()",
}
_SAFE = frozenset({"GET", "HEAD", "OPTIONS"})


class TooLargeError(Exception):
    """A body grew over its limit while it was read."""


class Guard:
    """Lets a request through, or answers it itself with one sentence."""

    def __init__(self, app: ASGIApp, policy: Policy) -> None:
        self._app = app
        self._policy = policy

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """The ASGI application."""
        if scope["type"] != "http":
            if scope["type"] == "lifespan":
                await self._app(scope, receive, send)
            return
        answered = False

        async def send_guarded(message: Message) -> None:
            nonlocal answered
            if message["type"] == "http.response.start":
                answered = True
                _add_headers(MutableHeaders(scope=message), scope["path"])
            await send(message)

        refused = self._refusal(scope)
        if refused is not None:
            await refused(scope, receive, send_guarded)
            return
        limit = self._limit(scope["path"])
        try:
            await self._app(scope, _limited(receive, limit), send_guarded)
        except TooLargeError:
            if not answered:
                await _too_large(limit)(scope, receive, send_guarded)

    def _limit(self, path: str) -> int:
        return self._policy.upload_bytes if path == UPLOAD_PATH else COMMAND_BYTES

    def _refusal(self, scope: Scope) -> JSONResponse | None:
        headers = Headers(scope=scope)
        host = headers.get("host", "")
        path, method = scope["path"], scope["method"]
        if not self._policy.knows_host(_name_of(host)):
            return refusal(
                421, f"this server is not called {host or 'nothing'}; use the address it printed"
            )
        api = path.startswith("/api/")
        if api and headers.get("sec-fetch-site", "same-origin") not in {"same-origin", "none"}:
            return refusal(403, "another site's page asked for this; open runglight's own page")
        if method not in _SAFE and (refused := self._refused_command(headers, path, host)):
            return refused
        if api and path != SESSION_PATH and not self.admits(headers):
            return refusal(401, "this server wants its token first")
        return None

    def _refused_command(self, headers: Headers, path: str, host: str) -> JSONResponse | None:
        origin = headers.get("origin")
        if origin is not None and urlsplit(origin).netloc != host:
            return refusal(403, f"the request comes from {origin}, not from this page")
        if headers.get(COMMAND_HEADER) is None:
            return refusal(403, "commands need the header X-Runglight; any value will do")
        if self._policy.read_only and path != SESSION_PATH and path not in QUESTION_PATHS:
            return refusal(403, "this server is read-only; it was started with --read-only")
        announced = headers.get("content-length", "0")
        if not announced.isdecimal() or int(announced) > self._limit(path):
            return _too_large(self._limit(path))
        return None

    def admits(self, headers: Headers) -> bool:
        """Whether the token is not needed, or there."""
        if self._policy.token is None:
            return True
        scheme, _, offered = headers.get("authorization", "").partition(" ")
        if scheme.lower() == "bearer" and self._policy.takes_token(offered.strip()):
            return True
        return self._policy.takes_session(cookie_of(headers))


def cookie_of(headers: Headers) -> str:
    """Our cookie; empty where there is none."""
    try:
        morsel = SimpleCookie(headers.get("cookie", "")).get(COOKIE)
    except CookieError:
        return ""
    return "" if morsel is None else morsel.value


def refusal(status: int, sentence: str) -> JSONResponse:
    """One sentence, as every error is told."""
    return JSONResponse({"error": sentence}, status)


def _too_large(limit: int) -> JSONResponse:
    return refusal(413, f"this is more than the {limit / 1e6:,.0f} MB that are taken at once")


def _name_of(host: str) -> str:
    """The name in a Host header, without the port."""
    try:
        return urlsplit(f"//{host}").hostname or ""
    except ValueError:
        return ""


def _limited(receive: Receive, limit: int) -> Receive:
    taken = 0

    async def receive_limited() -> Message:
        nonlocal taken
        message = await receive()
        if message["type"] == "http.request":
            taken += len(message.get("body", b""))
            if taken > limit:
                raise TooLargeError
        return message

    return receive_limited


def _add_headers(headers: MutableHeaders, path: str) -> None:
    for name, value in _HEADERS.items():
        headers[name] = value
    worker = path.startswith("/assets/") and "worker" in path
    headers["content-security-policy"] = WORKER_POLICY if worker else PAGE_POLICY
    if path.startswith("/api/"):
        # Only photos say otherwise: they never change.
        headers.setdefault("cache-control", "no-store")
