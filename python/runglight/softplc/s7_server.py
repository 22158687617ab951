"""A soft PLC's S7 server, made of python-snap7's."""

import asyncio
import logging
import socket
from collections.abc import Sequence
from contextlib import suppress
from threading import Lock
from typing import SupportsIndex

from snap7.server import Server as Snap7Server
from snap7.type import SrvArea

from runglight.plants.running import Image
from runglight.plants.symbols import Symbol
from runglight.softplc.listening import IPV4, check_free
from runglight.softplc.place import Area
from runglight.softplc.s7_layout import S7Layout
from runglight.softplc.serve_url import ServeUrl
from runglight.softplc.server import Look

# Whatever a client does wrong, it is told; the terminal is not for it.
logging.getLogger("snap7").addHandler(logging.NullHandler())

_SERVED = {
    Area.INPUT: SrvArea.PE,
    Area.OUTPUT: SrvArea.PA,
    Area.MEMORY: SrvArea.MK,
    Area.DATA: SrvArea.DB,
}


class ReadOnlyArea(bytearray):
    """Bytes that no client can change: snap7's server answers a refused write with an error."""

    def __setitem__(self, where: SupportsIndex | slice, value: object) -> None:
        raise TypeError("a soft PLC is read-only")

    def show(self, content: bytearray) -> None:
        """From now on it holds `content`, of the same length."""
        super().__setitem__(slice(None), content)


class _ScanServer(Snap7Server):
    """Answers one request at a time, each from one scan, and can hang up on its clients."""

    def __init__(self, layout: S7Layout, look: Look) -> None:
        super().__init__(log=False)
        self._layout = layout
        self._look = look
        self._answering = Lock()
        self._shown: Image | None = None
        self._sockets: set[socket.socket] = set()
        self._areas = {key: ReadOnlyArea(size) for key, size in layout.sizes.items()}
        for (area, block), content in self._areas.items():
            self.register_area(_SERVED[area], block, content)

    def hang_up(self) -> None:
        """Stops listening, and closes every client's connection."""
        self._drop_clients()  # else each is waited for
        self.stop()
        self._drop_clients()  # who came meanwhile

    def _drop_clients(self) -> None:
        for client in tuple(self._sockets):
            with suppress(OSError):
                client.shutdown(socket.SHUT_RDWR)

    def _handle_client(self, client_socket: socket.socket, address: tuple[str, int]) -> None:
        self._sockets.add(client_socket)
        try:
            super()._handle_client(client_socket, address)
        finally:
            self._sockets.discard(client_socket)

    def _process_request(
        self, request_data: bytes, client_address: tuple[str, int]
    ) -> bytes | None:
        with self._answering:
            if not self.running:
                raise ConnectionAbortedError("the server has been stopped")
            image = self._look()
            if image is not self._shown:
                for key, content in self._layout.areas(image).items():
                    self._areas[key].show(content)
                self._shown = image
            return super()._process_request(request_data, client_address)


class S7Server:
    """Process images, bit memory and the data blocks the plant has; reads only."""

    def __init__(self, symbols: Sequence[Symbol], look: Look) -> None:
        self._layout = S7Layout(symbols)
        self._look = look
        self._server: _ScanServer | None = None
        self.symbols = self._layout.symbols
        self.tap_query = self._layout.tap_query

    @property
    def clients(self) -> int:
        """How many are connected."""
        return 0 if self._server is None else self._server.client_count

    async def start(self, url: ServeUrl) -> int:
        """Listens; the port. IPv4 only, as snap7's server does."""
        host = check_free(url, IPV4)
        server = _ScanServer(self._layout, self._look)
        server.port = url.port
        server.start_to(host, url.port)
        self._server = server
        assert server.server_socket is not None
        port: int = server.server_socket.getsockname()[1]
        return port

    async def stop(self) -> None:
        """Hangs up on every client and listens no more."""
        server, self._server = self._server, None
        if server is not None:
            await asyncio.to_thread(server.hang_up)
