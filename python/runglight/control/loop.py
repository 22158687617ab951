"""The scan cycle of whoever controls or shadows a plant: read, think, write, on a grid of time."""

import asyncio
from collections.abc import Callable
from contextlib import suppress
from typing import Protocol

from runglight.control.link import Image, PlantLink
from runglight.taps.backoff import Backoff
from runglight.taps.clock import Clock
from runglight.taps.device import DeviceError
from runglight.taps.grid import Grid

Writes = list[tuple[int, int]]


class Stepper(Protocol):
    """Whoever thinks, once per scan."""

    def step(self, now_ns: int, image: Image) -> Writes:
        """Takes all terminals as they were read at `now_ns`; gives what to write."""

    def lost(self, now_ns: int, reason: str) -> None:
        """The plant did not answer."""

    def farewell(self) -> Writes:
        """What to write last, when the loop ends; nothing where nothing was ever written."""


class ScanLoop:
    """Scans until it is stopped. A lost connection is retried; what was missed is the stepper's.

    `grid` says when to scan.
    """

    def __init__(self, link: PlantLink, clock: Clock, grid: Grid, stepper: Stepper) -> None:
        self._link = link
        self._clock = clock
        self._grid = grid
        self._stepper = stepper
        self._stopping = asyncio.Event()
        self._backoff = Backoff()
        self.scans = 0
        """Scans so far."""

    def stop(self) -> None:
        """Ends after the scan under way."""
        self._stopping.set()

    async def run(
        self, until_ns: int | None = None, glance: Callable[[], None] | None = None
    ) -> None:
        """Scans until `until_ns`, or until stopped; `glance` is called after every scan.

        Whatever ends it, the stepper's farewell is written first. Raises InputError for what can
        never work.
        """
        connected = False
        # From here on a simulated machine's time waits for this task.
        await self._clock.sleep_until(self._clock.now_ns())
        try:
            while not self._stopping.is_set():
                now_ns = self._clock.now_ns()
                if until_ns is not None and now_ns >= until_ns:
                    break
                try:
                    if not connected:
                        await self._link.connect()
                        connected = True
                    await self._clock.sleep_until(self._grid.next_ns(self._clock.now_ns()))
                    image = await self._link.read()
                    writes = self._stepper.step(self._clock.now_ns(), image)
                    if writes:
                        await self._link.write(writes)
                except DeviceError as error:
                    connected = False
                    self._stepper.lost(self._clock.now_ns(), str(error))
                    await self._clock.sleep_until(self._clock.now_ns() + self._backoff.wait_ns())
                    continue
                self._backoff.reset()
                self.scans += 1
                if glance is not None:
                    glance()
        finally:
            await self._leave()

    async def _leave(self) -> None:
        """Also when interrupted: a machine is not left as it happens to stand."""
        writes = self._stepper.farewell()
        if writes:
            with suppress(DeviceError):
                await asyncio.shield(self._link.write(writes))
        await self._link.close()
