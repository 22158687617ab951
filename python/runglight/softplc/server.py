"""What a protocol's server does for a soft PLC."""

from collections.abc import Callable
from typing import Protocol

from runglight.plants.running import Image
from runglight.plants.symbols import Symbol
from runglight.softplc.serve_url import ServeUrl

Look = Callable[[], Image]
"""Lets the plant come up to now and gives its last scan; from any thread."""

Write = Callable[[list[tuple[int, int]]], None]
"""Lets the plant come up to now and sets its outputs: number among the outputs, and value."""


class Server(Protocol):
    """Answers clients of one protocol. Every answer shows one scan, the last before its request."""

    symbols: tuple[Symbol, ...]
    """The plant's, under the protocol's addresses."""
    tap_query: str
    """The options of a tap's URL that fit."""

    @property
    def clients(self) -> int:
        """How many are connected."""

    async def start(self, url: ServeUrl) -> int:
        """Listens; the port, which it chooses where the URL names 0. InputError where it cannot."""

    async def stop(self) -> None:
        """Hangs up on every client and listens no more."""
