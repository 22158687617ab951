"""Findings to a webhook: one JSON POST each."""

from __future__ import annotations

import asyncio
import contextlib
import hashlib
import http.client
import socket
import ssl
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from runglight import environment
from runglight.errors import InputError
from runglight.findings.finding import decode_finding
from runglight.live.delivery import RefusedError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from runglight.findings.store import Kept

TRY_AGAIN = frozenset({408, 425, 429})
"""Client errors that pass: too slow, too early, too much (RFC 9110, RFC 8470, RFC 6585)."""


class Webhook:
    """Posts findings, one request each; redirects are not followed."""

    at_once = 1
    timeout_s = 10.0
    from_the_start = False

    def __init__(self, url: str) -> None:
        try:
            parts = urlsplit(url)
            port = parts.port
        except ValueError as error:
            raise InputError(f"--webhook {url}: {error}") from None
        if parts.scheme not in {"http", "https"} or not parts.hostname:
            raise InputError(f"--webhook {url}: write https://HOST/PATH")
        if "@" in parts.netloc:
            raise InputError(
                "--webhook: a password does not belong in the address; "
                f"put the header into {environment.WEBHOOK_AUTHORIZATION}"
            )
        self.name = f"{parts.scheme}://{parts.netloc}{parts.path}"
        self._https = parts.scheme == "https"
        self._host, self._port = parts.hostname, port
        self._path = (parts.path or "/") + (f"?{parts.query}" if parts.query else "")

    async def run(self) -> None:
        """Nothing to do beside delivering."""

    async def deliver(self, findings: Sequence[Kept]) -> None:
        """Posts each finding; the same one always carries the same Idempotency-Key."""
        for kept in findings:
            connection = self._connection()
            try:
                status, reason = await asyncio.to_thread(self._post, connection, kept.line)
            finally:
                # Cancelled or timed out: this ends the thread's wait, too.
                _hang_up(connection)
            if 200 <= status < 300:
                continue
            if status >= 500 or status in TRY_AGAIN:
                raise OSError(f"it answered {status} {reason}")
            raise RefusedError(f"it answered {status} {reason}")

    async def close(self) -> None:
        """Every request has its own connection; there is nothing to let go of."""

    def _connection(self) -> http.client.HTTPConnection:
        if self._https:
            return http.client.HTTPSConnection(
                self._host, self._port, timeout=self.timeout_s, context=ssl.create_default_context()
            )
        return http.client.HTTPConnection(self._host, self._port, timeout=self.timeout_s)

    def _post(self, connection: http.client.HTTPConnection, line: str) -> tuple[int, str]:
        headers = {
            "Content-Type": "application/json",
            "User-Agent": "runglight",
            "Idempotency-Key": idempotency_key(line),
            "Connection": "close",
        }
        if authorization := environment.webhook_authorization():
            headers["Authorization"] = authorization
        connection.request("POST", self._path, body=line.encode(), headers=headers)
        answer = connection.getresponse()
        return answer.status, answer.reason


def idempotency_key(line: str) -> str:
    """The finding's id and state, and what tells its lines apart."""
    finding = decode_finding(line)
    digest = hashlib.sha256(line.encode()).hexdigest()[:16]
    return f"{finding.id}-{finding.state}-{digest}"


def _hang_up(connection: http.client.HTTPConnection) -> None:
    if connection.sock is not None:
        with contextlib.suppress(OSError):
            connection.sock.shutdown(socket.SHUT_RDWR)
    connection.close()
