"""A running plant made of a machine, a PLC program and the scan cycle between them."""

from collections.abc import Callable, Sequence
from typing import Generic

from runglight.plants.logger import ChangeDetector
from runglight.plants.running import ChangeListener, Image
from runglight.plants.scan import Controller, Plant, ScanCycle, Value, no_memory
from runglight.plants.symbols import SignalClass, Symbol


class ScannedPlant(Generic[Value]):
    """What every running plant does alike; its faults are for each plant to add.

    `image` is what a logger at the PLC sees: the inputs as the last scan read them, and the
    outputs and the memory as that scan found them.
    """

    def __init__(
        self,
        symbols: tuple[Symbol, ...],
        plant: Plant[Value],
        controller: Controller[Value],
        *,
        start_ns: int,
        outputs: tuple[Value, ...],
        memory: Callable[[], tuple[int, ...]] = no_memory,
    ) -> None:
        self._symbols = symbols
        self._now_ns = start_ns
        self._image = Image()
        self._listeners: list[ChangeListener] = []
        self._detector = ChangeDetector(
            self._numbers("input"), self._numbers("output"), self._tell, self._numbers("memory")
        )
        self._cycle = ScanCycle(
            plant, controller, self, start_ns=start_ns, outputs=outputs, memory=memory
        )

    @property
    def symbols(self) -> tuple[Symbol, ...]:
        """The PLC's signals."""
        return self._symbols

    @property
    def now_ns(self) -> int:
        """Until when the plant has run."""
        return self._now_ns

    def advance(self, now_ns: int) -> None:
        """Runs every PLC scan due by `now_ns`."""
        self._now_ns = max(self._now_ns, now_ns)
        self._cycle.advance(now_ns)

    def next_change_ns(self) -> int | None:
        """The next PLC scan that may change anything; None while everything stands still."""
        return self._cycle.next_scan_ns()

    def image(self) -> Image:
        """What the last scan shows."""
        return self._image

    def on_change(self, listener: ChangeListener) -> None:
        """From now on `listener` hears every change of the image."""
        self._listeners.append(listener)

    def sample(
        self,
        time_ns: int,
        inputs: tuple[int, ...],
        outputs: tuple[int, ...],
        memory: tuple[int, ...] = (),
    ) -> None:
        """The scan cycle shows its images."""
        self._image = Image(inputs, outputs, memory)
        self._detector.sample(time_ns, inputs, outputs, memory)

    def _numbers(self, signal_class: SignalClass) -> Sequence[int]:
        return [
            number
            for number, symbol in enumerate(self._symbols)
            if symbol.signal_class == signal_class
        ]

    def _tell(self, time_ns: int, number: int, value: int) -> None:
        for listener in self._listeners:
            listener(time_ns, number, value)
