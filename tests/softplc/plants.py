"""Made for tests: a plant that shows which scan it is in, clocks, a soft PLC in a thread."""

import asyncio
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager

from runglight.plants import FaultDescription, FaultLabel, Image, RunningPlant, Symbol
from runglight.plants.running import ChangeListener
from runglight.softplc import SoftPlc, serve
from runglight.taps.clock import Clock

SCAN_NS = 10_000_000


def _symbol(address: str, name: str, signal_class: str, type_: str = "BOOL") -> Symbol:
    return Symbol(address, "G", "Count", name, signal_class, name, type_)  # type: ignore[arg-type]


class CountingPlant:
    """Shows the number of its scan in 16 inputs, in 16 outputs, and in whichever words it has.

    A mixture of two scans therefore shows at once.
    """

    faults: Mapping[int, FaultDescription] = {}
    cycles = 0

    def __init__(self, start_ns: int, words: tuple[Symbol, ...] = ()) -> None:
        self.symbols = (
            *(_symbol(f"%IX{bit // 8}.{bit % 8}", f"I{bit}", "input") for bit in range(16)),
            *(_symbol(f"%QX{bit // 8}.{bit % 8}", f"Q{bit}", "output") for bit in range(16)),
            *words,
        )
        self._start_ns = start_ns
        self._words = {
            name: sum(symbol.signal_class == name for symbol in words)
            for name in ("input", "output", "memory")
        }
        self._image = Image()
        self.scans = 0

    def advance(self, now_ns: int) -> None:
        scans = (now_ns - self._start_ns) // SCAN_NS
        if scans == self.scans and self._image.inputs:
            return
        self.scans = scans
        bits = tuple(scans >> bit & 1 for bit in range(16))
        self._image = Image(
            bits + (scans,) * self._words["input"],
            bits + (scans,) * self._words["output"],
            (scans,) * self._words["memory"],
        )

    def image(self) -> Image:
        return self._image

    def on_change(self, listener: ChangeListener) -> None: ...

    def inject(self, fault: int | str, at_ns: int | None = None) -> FaultDescription:
        raise ValueError

    def labels(self) -> tuple[FaultLabel, ...]:
        return ()

    def waiting(self) -> tuple[FaultDescription, ...]:
        return ()

    def acting(self) -> tuple[FaultDescription, ...]:
        return ()


def word(address: str, signal_class: str) -> Symbol:
    """A 16-bit word at an address."""
    return _symbol(address, address.strip("%"), signal_class, "UINT")


class Steered:
    """A clock that stands where the test puts it."""

    def __init__(self, now_ns: int) -> None:
        self.time_ns = now_ns

    def now_ns(self) -> int:
        return self.time_ns

    async def sleep_until(self, time_ns: int) -> None:
        raise NotImplementedError

    def take_step_ns(self) -> None:
        return


class Racing(Steered):
    """A clock that is one scan further whenever it is asked."""

    def now_ns(self) -> int:
        self.time_ns += SCAN_NS
        return self.time_ns


@contextmanager
def served(
    plant: RunningPlant, url: str, clock: Clock, *, keep_changes: bool = False
) -> Iterator[tuple[SoftPlc, Callable[..., object]]]:
    """A soft PLC in a thread of its own, for clients that block; `call` runs a coroutine there."""
    started: list[SoftPlc] = []
    loop = asyncio.new_event_loop()
    ready, failed = threading.Event(), []
    end = asyncio.Event()

    async def work() -> None:
        try:
            async with serve(plant, url, clock, keep_changes=keep_changes) as plc:
                started.append(plc)
                ready.set()
                await end.wait()
        except BaseException as error:
            failed.append(error)
            ready.set()

    thread = threading.Thread(target=loop.run_until_complete, args=(work(),))
    thread.start()
    try:
        assert ready.wait(30)
        if failed:
            raise failed[0]

        def call(work: Callable[[], object]) -> object:
            return asyncio.run_coroutine_threadsafe(work(), loop).result(30)  # type: ignore[arg-type]

        yield started[0], call
    finally:
        loop.call_soon_threadsafe(end.set)
        thread.join(30)
        loop.close()
