"""A real server of one protocol on loopback, and how to work it."""

import socket
from abc import ABC, abstractmethod
from typing import Self

LOOPBACK = "127.0.0.1"


class Bench(ABC):
    """Started, worked and stopped inside the test's event loop."""

    live = True
    """Values can be changed, and the server killed; a replayed log has neither."""
    polls = True
    """Batches tell the time of every scan."""
    signals: tuple[str, ...]
    """Names of the signals at `url`, in the order of their indices."""
    changing: str
    """The signal that `change` changes."""
    name_of_missing: str | None = None
    """A signal that `missing_url` asks for in vain, where the protocol can tell."""
    missing_url: str

    @property
    @abstractmethod
    def url(self) -> str:
        """What to tap, without an interval."""

    @property
    def unreachable_url(self) -> str | None:
        """The same at a port where nobody listens; None where there is no such thing."""
        return None

    async def __aenter__(self) -> Self:
        await self.start()
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.kill()

    @abstractmethod
    async def start(self) -> None:
        """Starts the server, all values at zero; again after `kill`, at the same port."""

    async def change(self, value: int) -> None:
        """Gives `changing` a value; done when it returns."""
        raise NotImplementedError

    @abstractmethod
    async def kill(self) -> None:
        """Ends the server and its connections, as pulling the plug would. May be called twice."""


def free_port() -> int:
    """A port on loopback where nobody listens."""
    with socket.socket() as found:
        found.bind((LOOPBACK, 0))
        port: int = found.getsockname()[1]
        return port
