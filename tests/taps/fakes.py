"""A clock that a test moves, and a device that does what a test says."""

import asyncio
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from runglight.taps.base import Answer, TapSignal

START_NS = 1_000_000_000_000
MS = 1_000_000


class FakeClock:
    """Sleeping takes the time it should; everything else takes what a test adds to `time_ns`."""

    def __init__(self) -> None:
        self.time_ns = START_NS
        self.steps: list[int] = []
        self.slept_until_ns: list[int] = []

    def now_ns(self) -> int:
        return self.time_ns

    async def sleep_until(self, time_ns: int) -> None:
        self.slept_until_ns.append(time_ns)
        await asyncio.sleep(0)
        self.time_ns = max(self.time_ns, time_ns)

    def take_step_ns(self) -> int | None:
        return self.steps.pop(0) if self.steps else None


class FakeDevice:
    """Four bits. `script` says what each read does: bytes, an error, or a call that gives bytes.

    After the script it repeats its last bytes.
    """

    def __init__(self, script: list[bytes | Exception | Callable[[], bytes]]) -> None:
        self.signals = [TapSignal(f"I0.{bit}", f"I0.{bit}") for bit in range(4)]
        self.script = script
        self.image = b"\0"
        self.refusals: list[Exception] = []
        self.connects = 0
        self.reads = 0
        self.is_open = False

    def values(self, image: bytes) -> npt.NDArray[np.int64]:
        bits = np.unpackbits(np.frombuffer(image, np.uint8), bitorder="little")
        return bits[:4].astype(np.int64)

    async def connect(self) -> None:
        self.connects += 1
        if self.refusals:
            raise self.refusals.pop(0)
        self.is_open = True

    async def read(self) -> bytes:
        assert self.is_open
        self.reads += 1
        if self.script:
            step = self.script.pop(0)
            if isinstance(step, Exception):
                raise step
            self.image = step if isinstance(step, bytes) else step()
        return self.image

    async def check(self) -> list[Answer]:
        return []

    async def close(self) -> None:
        self.is_open = False
