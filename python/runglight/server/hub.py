"""News for every open page: server-sent events (HTML Standard, 9.2)."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

import msgspec

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

WAITING_AT_MOST = 256
"""Messages that wait for a page that reads slowly; then it is told to ask anew."""
KEEP_ALIVE_S = 15.0
_encoder = msgspec.json.Encoder()


class Hub:
    """Tells every subscriber the same; nobody is waited for."""

    def __init__(self) -> None:
        self._subscribers: set[asyncio.Queue[bytes | None]] = set()
        self._closed = False

    @property
    def subscribers(self) -> int:
        """How many pages listen."""
        return len(self._subscribers)

    def publish(self, event: str, content: object) -> None:
        """Sends one event. From the event loop's thread."""
        if not self._subscribers:
            return
        message = event_message(event, content)
        for queue in self._subscribers:
            if queue.qsize() >= WAITING_AT_MOST:
                # What it missed is not told: it is told that it missed something.
                while not queue.empty():
                    queue.get_nowait()
                queue.put_nowait(event_message("resync", None))
            else:
                queue.put_nowait(message)

    def close(self) -> None:
        """Ends every subscription."""
        self._closed = True
        for queue in self._subscribers:
            queue.put_nowait(None)

    async def subscribe(self, first: object) -> AsyncIterator[bytes]:
        """The messages from now on, beginning with an event `hello` of `first`."""
        queue: asyncio.Queue[bytes | None] = asyncio.Queue()
        self._subscribers.add(queue)
        try:
            yield event_message("hello", first)
            while not self._closed:
                try:
                    async with asyncio.timeout(KEEP_ALIVE_S):
                        message = await queue.get()
                except TimeoutError:
                    yield b": still here\n\n"
                    continue
                if message is None:
                    return
                yield message
        finally:
            self._subscribers.discard(queue)


def event_message(event: str, content: object) -> bytes:
    """One event as it goes over the line; JSON has no line breaks of its own."""
    return b"event: " + event.encode() + b"\ndata: " + _encoder.encode(content) + b"\n\n"
