"""The server itself: listens, prints where, and ends cleanly."""

from __future__ import annotations

import asyncio
import logging
import socket
from contextlib import contextmanager
from typing import TYPE_CHECKING

import uvicorn

from runglight.errors import InputError
from runglight.server.application import application

if TYPE_CHECKING:
    from collections.abc import Iterator

    from runglight.server.workshop import Workshop

CLOSING_S = 2


class _Server(uvicorn.Server):
    """Ends the event streams first: they would keep it from ending."""

    def __init__(self, config: uvicorn.Config, workshop: Workshop) -> None:
        super().__init__(config)
        self._workshop = workshop

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        self._workshop.hub.close()
        await super().shutdown(sockets)

    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        """The command that serves has its own handlers."""
        yield


def listen(host: str, port: int) -> socket.socket:
    """A socket that listens; InputError where that cannot be."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    listening = socket.socket(family, socket.SOCK_STREAM)
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind((host, port))
        # Whoever reads the address and asks at once waits, and is not turned away.
        listening.listen(128)
    except (OSError, UnicodeError) as error:
        listening.close()
        why = error.strerror if isinstance(error, OSError) else error
        raise InputError(
            f"--host {host} --port {port}: cannot listen there ({why}); "
            "choose another port, or --port 0 for any"
        ) from None
    return listening


def address_of(listening: socket.socket) -> str:
    """What to type into a browser."""
    host, port = listening.getsockname()[:2]
    shown = {"0.0.0.0": "127.0.0.1", "::": "::1"}.get(host, host)
    return f"http://[{shown}]:{port}/" if ":" in shown else f"http://{shown}:{port}/"


class PageServer:
    """Serves a workshop on a socket until it is stopped."""

    def __init__(self, workshop: Workshop, listening: socket.socket) -> None:
        self._listening = listening
        # What a request looked like is nobody's business; what breaks is told by the routes.
        logging.getLogger("uvicorn.error").setLevel(logging.CRITICAL)
        self._server = _Server(
            uvicorn.Config(
                application(workshop),
                log_config=None,
                access_log=False,
                server_header=False,
                date_header=False,
                timeout_graceful_shutdown=CLOSING_S,
                lifespan="off",
            ),
            workshop,
        )
        self._workshop = workshop

    async def run(self) -> None:
        """Opens the workshop (InputError where it cannot be) and serves."""
        await self._workshop.open()
        try:
            await self._server.serve([self._listening])
        finally:
            await self._workshop.close()

    def stop(self) -> None:
        """Ends it soon."""
        self._server.should_exit = True

    @property
    def started(self) -> bool:
        """Whether it answers."""
        return self._server.started


async def served(server: PageServer, stopping: asyncio.Event) -> None:
    """Serves until told to stop."""
    running = asyncio.create_task(server.run())
    waiting = asyncio.create_task(stopping.wait())
    await asyncio.wait({running, waiting}, return_when=asyncio.FIRST_COMPLETED)
    waiting.cancel()
    server.stop()
    await running
