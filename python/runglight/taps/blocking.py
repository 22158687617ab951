"""Two ways to scan with a library that blocks: in a thread of ours, or beside an event loop."""

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from runglight.taps.base import Answer
from runglight.taps.device import BlockingDevice

Result = TypeVar("Result")


class Blocking:
    """Blocks whoever awaits: right where the whole thread belongs to the scanner."""

    def __init__(self, device: BlockingDevice) -> None:
        self._device = device
        self.signals = device.signals

    def values(self, image: bytes) -> npt.NDArray[np.int64]:
        """The value of every signal."""
        return self._device.values(image)

    async def connect(self) -> None:
        """Connects anew."""
        await self._run(self._device.connect)

    async def read(self) -> bytes:
        """All signals as they stand."""
        return await self._run(self._device.read)

    async def check(self) -> list[Answer]:
        """Asks for every signal once."""
        return await self._run(self._device.check)

    async def close(self) -> None:
        """Lets go of the connection."""
        await self._run(self._device.close)

    async def _run(self, call: Callable[[], Result]) -> Result:
        return call()


class Beside(Blocking):
    """Blocks one thread of its own, so that the event loop goes on: a hop to and fro per read."""

    def __init__(self, device: BlockingDevice) -> None:
        super().__init__(device)
        self._thread = ThreadPoolExecutor(1, "runglight-device")

    async def close(self) -> None:
        """Lets go of the connection; the thread ends."""
        await super().close()
        self._thread.shutdown(wait=False)
        self._thread = ThreadPoolExecutor(1, "runglight-device")

    async def _run(self, call: Callable[[], Result]) -> Result:
        return await asyncio.get_running_loop().run_in_executor(self._thread, call)
