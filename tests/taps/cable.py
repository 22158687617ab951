"""A cable between a tap and its server that can be cut: nothing passes, and nobody is told."""

import asyncio
from typing import Self


class Cable:
    """Forwards a port of its own to a server, until it is cut."""

    def __init__(self, server_port: int, port: int = 0) -> None:
        self._server_port = server_port
        self._whole = True
        self._tasks: set[asyncio.Task[None]] = set()
        self._listener: asyncio.Server | None = None
        self.port = port

    async def __aenter__(self) -> Self:
        await self.open()
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()

    async def open(self) -> None:
        """Lets taps connect."""
        self._listener = await asyncio.start_server(self._connected, "127.0.0.1", self.port)
        self.port = self._listener.sockets[0].getsockname()[1]

    async def close(self) -> None:
        """Ends all connections, and lets nobody connect. May be called twice."""
        if self._listener is not None:
            self._listener.close()
            self._listener = None
        for task in tuple(self._tasks):
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    def cut(self) -> None:
        """From now on every byte is lost, on this connection and on new ones."""
        self._whole = False

    def mend(self) -> None:
        """New connections work; those from before stay dead."""
        for task in tuple(self._tasks):
            task.cancel()
        self._whole = True

    async def _connected(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        task = asyncio.current_task()
        assert task is not None
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)
        try:
            if not self._whole:
                await asyncio.Event().wait()
            there, back = await asyncio.open_connection("127.0.0.1", self._server_port)
            try:
                async with asyncio.TaskGroup() as both:
                    both.create_task(self._pass(reader, back))
                    both.create_task(self._pass(there, writer))
            finally:
                back.close()
        except (asyncio.CancelledError, Exception):
            pass
        finally:
            writer.close()

    async def _pass(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        while data := await reader.read(65_536):
            if not self._whole:
                await asyncio.Event().wait()
            writer.write(data)
            await writer.drain()
        raise EOFError
