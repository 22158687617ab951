"""A server that answers a request with whatever a test says, right or wrong."""

import asyncio
from collections.abc import Callable
from types import TracebackType
from typing import Self

Answer = Callable[[bytes], bytes | None]
"""Gives the reply to one frame; None for no reply at all."""


class ScriptedServer:
    """Takes frames apart with `frame_bytes` (length of the first frame, 0 while incomplete)."""

    def __init__(self, answer: Answer, frame_bytes: Callable[[bytes], int]) -> None:
        self.answer = answer
        self.connections = 0
        self.frames = 0
        self._frame_bytes = frame_bytes
        self._server: asyncio.Server | None = None
        self._writers: set[asyncio.StreamWriter] = set()
        self.port = 0

    async def __aenter__(self) -> Self:
        self._server = await asyncio.start_server(self._serve, "127.0.0.1", 0)
        self.port = self._server.sockets[0].getsockname()[1]
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        assert self._server is not None
        self._server.close()
        for writer in list(self._writers):
            writer.close()
            # A peer that has gone already is no matter.
            await asyncio.gather(writer.wait_closed(), return_exceptions=True)

    def drop(self) -> None:
        """Closes all connections; new ones are accepted."""
        for writer in list(self._writers):
            writer.close()

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.connections += 1
        self._writers.add(writer)
        came = b""
        try:
            while more := await reader.read(4096):
                came += more
                while length := self._frame_bytes(came):
                    frame, came = came[:length], came[length:]
                    self.frames += 1
                    reply = self.answer(frame)
                    if reply:
                        writer.write(reply)
        except OSError:
            pass
        finally:
            self._writers.discard(writer)
            writer.close()


def modbus_frame_bytes(came: bytes) -> int:
    length = int.from_bytes(came[4:6], "big") + 6
    return length if len(came) >= 8 and len(came) >= length else 0


def never_complete(came: bytes) -> int:
    """For a server that accepts and says nothing."""
    return 0
