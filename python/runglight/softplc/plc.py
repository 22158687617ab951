"""A running plant with a server: a PLC that taps can tap, and tests can kill."""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress
from dataclasses import replace
from threading import RLock
from typing import NamedTuple

from runglight.plants.faults import FaultDescription, FaultLabel
from runglight.plants.running import (
    Image,
    PhotographedPlant,
    PlantPhoto,
    RunningPlant,
    WritablePlant,
)
from runglight.plants.symbols import Symbol
from runglight.softplc.serve_url import ServeUrl, parse_serve_url
from runglight.softplc.server import Look, Server, Write
from runglight.taps.clock import Clock

CATCH_UP_S = 0.05
"""The plant never lies further behind than this (real seconds), even if nobody reads."""

_EVERYWHERE = {"0.0.0.0": "127.0.0.1", "::": "::1"}
"""Where a client on this computer finds a server that listens at every address."""


class PlcChange(NamedTuple):
    """One signal changed in the scan at `time_ns`; `signal` is its full name."""

    time_ns: int
    signal: str
    value: int


class SoftPlc:
    """Serves a running plant in the time of a clock.

    Whenever a client asks, the plant has just been brought up to the clock's now, so that an
    answer shows the last scan before it, however fast time goes. `stop` kills the server alone:
    the machine works on, unseen, and `start` serves it again at the same port.
    """

    def __init__(
        self, plant: RunningPlant, url: str, clock: Clock, *, keep_changes: bool = False
    ) -> None:
        self._plant = plant
        self._clock = clock
        self._lock = RLock()
        self._url = parse_serve_url(url)
        write = self._write if isinstance(plant, WritablePlant) else None
        self._server = _server(self._url, plant, self.look, write)
        self._catching_up: asyncio.Task[None] | None = None
        self._changes: list[PlcChange] = []
        self._changed = 0
        names = [symbol.name for symbol in plant.symbols]

        def hear(time_ns: int, number: int, value: int) -> None:
            self._changed += 1
            if keep_changes:
                self._changes.append(PlcChange(time_ns, names[number], value))

        plant.on_change(hear)

    @property
    def url(self) -> ServeUrl:
        """Where it listens, or did last; its port is known once it has started."""
        return self._url

    @property
    def tap_url(self) -> str:
        """The URL with which a tap on this computer reads every signal at every scan."""
        host = _EVERYWHERE.get(self._url.host, self._url.host)
        return f"{replace(self._url, host=host)}?{self._server.tap_query}&interval=10ms"

    @property
    def symbols(self) -> tuple[Symbol, ...]:
        """The plant's symbol table, with the addresses under which a tap sees them."""
        return self._server.symbols

    @property
    def writable(self) -> bool:
        """Whether a controller elsewhere can write the plant's outputs."""
        return isinstance(self._plant, WritablePlant) and self._url.scheme == "modbus"

    @property
    def serving(self) -> bool:
        """Whether clients are answered."""
        return self._catching_up is not None

    @property
    def clients(self) -> int:
        """How many are connected."""
        return self._server.clients

    @property
    def change_count(self) -> int:
        """Changes of the image so far."""
        return self._changed

    @property
    def changes(self) -> list[PlcChange]:
        """Every change up to now, in time order; empty unless they were to be kept."""
        with self._lock:
            self.look()
            return list(self._changes)

    def look(self) -> Image:
        """Brings the plant up to the clock's now; its last scan. From any thread."""
        with self._lock:
            self._plant.advance(self._clock.now_ns())
            return self._plant.image()

    def expose(self) -> Callable[[], PlantPhoto]:
        """Brings the plant up to the clock's now and holds a camera before it. From any thread.

        TypeError for a plant that cannot be photographed.
        """
        plant = self._plant
        if not isinstance(plant, PhotographedPlant):
            raise TypeError("there is nothing to be seen of this plant")
        with self._lock:
            self.look()
            return plant.expose()

    def _write(self, outputs: list[tuple[int, int]]) -> None:
        with self._lock:
            self.look()
            assert isinstance(self._plant, WritablePlant)
            for number, value in outputs:
                self._plant.write(number, value)

    def inject(self, fault: int | str, at_ns: int | None = None) -> FaultDescription:
        """Breaks something at the next possible moment after `at_ns` (None: now).

        ValueError for a fault the plant has not, or that waits or acts already.
        """
        with self._lock:
            self.look()
            return self._plant.inject(fault, at_ns)

    def labels(self) -> tuple[FaultLabel, ...]:
        """The truth about every fault that has begun by now."""
        with self._lock:
            self.look()
            return self._plant.labels()

    async def start(self) -> None:
        """Listens; InputError where it cannot. Does nothing while it serves."""
        if self.serving:
            return
        self.look()
        port = await self._server.start(self._url)
        self._url = replace(self._url, port=port)
        self._catching_up = asyncio.create_task(self._catch_up())

    async def stop(self) -> None:
        """Hangs up on every client and listens no more. Does nothing where it does not serve."""
        task, self._catching_up = self._catching_up, None
        if task is None:
            return
        await self._server.stop()
        task.cancel()
        with suppress(asyncio.CancelledError):
            await task

    async def _catch_up(self) -> None:
        while True:
            self.look()
            await asyncio.sleep(CATCH_UP_S)


@asynccontextmanager
async def serve(
    plant: RunningPlant, url: str, clock: Clock, *, keep_changes: bool = False
) -> AsyncIterator[SoftPlc]:
    """Serves a plant for as long as one is inside.

    `async with serve(plant, "modbus://127.0.0.1:0", SteadyClock()) as plc: …`. Raises InputError
    for a URL that cannot be served, and where a signal of the plant has no place in the protocol.
    """
    plc = SoftPlc(plant, url, clock, keep_changes=keep_changes)
    await plc.start()
    try:
        yield plc
    finally:
        await plc.stop()


def _server(url: ServeUrl, plant: RunningPlant, look: Look, write: Write | None) -> Server:
    # A protocol's library is loaded when that protocol is served.
    if url.scheme == "s7":
        from runglight.softplc.s7_server import S7Server  # noqa: PLC0415

        return S7Server(plant.symbols, look)
    from runglight.softplc.modbus_server import ModbusServer  # noqa: PLC0415

    return ModbusServer(plant.symbols, look, write)
