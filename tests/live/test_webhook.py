"""Findings to a real HTTP server on loopback."""

import asyncio
import json
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import pytest

from runglight.errors import InputError
from runglight.findings.store import Kept
from runglight.live.delivery import RefusedError
from runglight.live.webhook import Webhook, idempotency_key


class Server(ThreadingHTTPServer):
    """Answers with the statuses it was given, then 204; holds requests while `held` is clear."""

    daemon_threads = True

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), Handler)
        self.posted: list[tuple[str, dict[str, str], bytes]] = []
        self.statuses: list[int] = []
        self.free = threading.Event()
        self.free.set()

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.server_port}/findings?line=3"


class Handler(BaseHTTPRequestHandler):
    server: Server

    def do_POST(self) -> None:
        body = self.rfile.read(int(self.headers["Content-Length"]))
        self.server.free.wait(30)
        self.server.posted.append((self.path, dict(self.headers), body))
        self.send_response(self.server.statuses.pop(0) if self.server.statuses else 204)
        self.end_headers()

    def log_message(self, *_said: object) -> None:
        """Tests are silent."""


@pytest.fixture
def server() -> Iterator[Server]:
    with Server() as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield server
        server.free.set()
        server.shutdown()
        thread.join()


@pytest.fixture
def finding(offline: list[str]) -> Kept:
    return Kept(1, offline[0], None)


def test_one_post_per_finding(
    server: Server, offline: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("RUNGLIGHT_WEBHOOK_AUTHORIZATION", "Bearer 123")
    findings = [Kept(number, line, None) for number, line in enumerate(offline)]
    asyncio.run(Webhook(server.url).deliver(findings))
    assert [body.decode() for _, _, body in server.posted] == offline
    path, headers, body = server.posted[0]
    assert path == "/findings?line=3"
    assert headers["Content-Type"] == "application/json"
    assert headers["Authorization"] == "Bearer 123"
    assert headers["Idempotency-Key"].startswith(json.loads(body)["id"])
    assert len({headers["Idempotency-Key"] for _, headers, _ in server.posted}) == len(offline)


def test_the_key_of_a_line_never_changes(server: Server, finding: Kept) -> None:
    async def main() -> None:
        webhook = Webhook(server.url)
        await webhook.deliver([finding])
        await webhook.deliver([finding])

    asyncio.run(main())
    keys = [headers["Idempotency-Key"] for _, headers, _ in server.posted]
    assert keys == [idempotency_key(finding.line)] * 2
    assert "Authorization" not in server.posted[0][1]


@pytest.mark.parametrize("status", [500, 503, 429, 408])
def test_what_passes_is_tried_again(server: Server, finding: Kept, status: int) -> None:
    server.statuses = [status]
    with pytest.raises(OSError, match=f"it answered {status}"):
        asyncio.run(Webhook(server.url).deliver([finding]))


@pytest.mark.parametrize("status", [400, 401, 404, 413, 301])
def test_what_does_not_pass_is_refused(server: Server, finding: Kept, status: int) -> None:
    server.statuses = [status]
    with pytest.raises(RefusedError, match=f"it answered {status}"):
        asyncio.run(Webhook(server.url).deliver([finding]))


def test_a_server_that_never_answers_is_left(server: Server, finding: Kept) -> None:
    server.free.clear()

    async def main() -> None:
        with pytest.raises(TimeoutError):
            async with asyncio.timeout(0.2):
                await Webhook(server.url).deliver([finding])

    # It returns although the server still holds the request: the thread was let go.
    asyncio.run(main())
    assert not server.posted


def test_nobody_listening(finding: Kept) -> None:
    with pytest.raises(OSError, match="refused"):
        asyncio.run(Webhook("http://127.0.0.1:9/").deliver([finding]))


@pytest.mark.parametrize("url", ["ftp://host/x", "http://", "host/path", "http://h:99999/"])
def test_what_is_no_address_is_refused(url: str) -> None:
    with pytest.raises(InputError, match="--webhook"):
        Webhook(url)


def test_a_password_in_the_address_is_refused_and_not_repeated() -> None:
    with pytest.raises(InputError, match="RUNGLIGHT_WEBHOOK_AUTHORIZATION") as refused:
        Webhook("https://me:secret@host/x")
    assert "secret" not in str(refused.value)
