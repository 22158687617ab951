"""An S7 with three input bytes, two output bytes, two memory bytes and a data block."""

import asyncio

from snap7.server import Server
from snap7.type import SrvArea

from tests.taps.benches.bench import LOOPBACK, Bench, free_port


def bit_names(prefix: str, count: int) -> list[str]:
    return [f"{prefix}{byte}.{bit}" for byte in range(count) for bit in range(8)]


class S7Bench(Bench):
    signals = (
        *bit_names("I", 3),
        *bit_names("Q", 2),
        *bit_names("M", 2),
        *bit_names("DB1.DBX", 5),
    )
    changing = "Q1.2"
    name_of_missing = "DB1.DBX9.0"

    def __init__(
        self, *, host: str = LOOPBACK, port: int | None = None, data_bytes: int = 5
    ) -> None:
        self.host = host
        self.port = port or free_port()
        self._data_bytes = data_bytes
        self._server: Server | None = None
        self._areas: dict[SrvArea, bytearray] = {}

    @property
    def url(self) -> str:
        return f"s7://{self.host}:{self.port}?pe=0-2&pa=0-1&mk=0-1&db1=0-4"

    @property
    def missing_url(self) -> str:
        return f"s7://127.0.0.1:{self.port}?pe=0-2&db1=0-9"

    @property
    def unreachable_url(self) -> str:
        return f"s7://127.0.0.1:{free_port()}?pe=0-2"

    async def start(self) -> None:
        self._areas = {
            SrvArea.PE: bytearray(3),
            SrvArea.PA: bytearray(2),
            SrvArea.MK: bytearray(2),
            SrvArea.DB: bytearray(self._data_bytes),
        }
        self._server = Server(log=False)
        for area, memory in self._areas.items():
            self._server.register_area(area, int(area is SrvArea.DB), memory)
        self._server.start_to(self.host, self.port)

    async def change(self, value: int) -> None:
        self.write(SrvArea.PA, 1, value << 2)

    def write(self, area: SrvArea, byte: int, value: int) -> None:
        self._areas[area][byte] = value

    async def kill(self) -> None:
        if self._server is not None:
            await asyncio.to_thread(self._server.stop)
            self._server = None
