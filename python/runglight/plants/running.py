"""A plant that runs for as long as somebody looks: the seam between machines and soft PLCs."""

from collections.abc import Callable, Mapping
from typing import NamedTuple, Protocol, runtime_checkable

from runglight.plants.faults import FaultDescription, FaultLabel
from runglight.plants.symbols import Symbol

ChangeListener = Callable[[int, int, int], None]
"""Hears a change: time of its scan in nanoseconds, index into the plant's symbols, new value."""


class Image(NamedTuple):
    """What one scan of the PLC shows: the values of its signals, class by class.

    Each in the order in which the signals of that class stand in the plant's symbol table; bits
    are 0 and 1, words are whole numbers within their type.
    """

    inputs: tuple[int, ...] = ()
    outputs: tuple[int, ...] = ()
    memory: tuple[int, ...] = ()


class RunningPlant(Protocol):
    """A machine and its PLC, advanced from outside, without an end.

    Nothing happens before the first `advance`, which runs the first scan at the plant's start.
    Not made for several threads: whoever shares it takes a lock.
    """

    @property
    def symbols(self) -> tuple[Symbol, ...]:
        """The PLC's signals."""

    @property
    def faults(self) -> Mapping[int, FaultDescription]:
        """What can be injected."""

    @property
    def cycles(self) -> int:
        """Parts (or batches) begun so far."""

    def advance(self, now_ns: int) -> None:
        """Runs every PLC scan due by `now_ns`; a time that has passed already changes nothing."""

    def image(self) -> Image:
        """What the last scan shows; always one scan, never a mixture of two."""

    def on_change(self, listener: ChangeListener) -> None:
        """From now on `listener` hears every change of the image, also the signals ON at start."""

    def inject(self, fault: int | str, at_ns: int | None = None) -> FaultDescription:
        """Breaks something (by number or name) at the next possible moment after `at_ns`.

        None, and a time that has passed, mean now. ValueError for a fault the plant has not, or
        that waits or acts already.
        """

    def labels(self) -> tuple[FaultLabel, ...]:
        """The truth about every fault that has begun, in the order of their beginnings."""

    def waiting(self) -> tuple[FaultDescription, ...]:
        """Faults injected that have not begun yet."""

    def acting(self) -> tuple[FaultDescription, ...]:
        """Faults that have begun and not passed."""


class PlantPhoto(NamedTuple):
    """A photo of a machine."""

    time_ns: int
    content: bytes
    """JPEG, with its time in the EXIF."""


@runtime_checkable
class PhotographedPlant(Protocol):
    """A plant that a camera can be held before."""

    def expose(self) -> Callable[[], PlantPhoto]:
        """Sees the machine as it stands at the time it was advanced to.

        What it gives develops the photo, in any thread and however late. InputError where Pillow
        is not installed.
        """


@runtime_checkable
class WritablePlant(RunningPlant, Protocol):
    """A machine without a PLC of its own: a controller elsewhere writes its outputs."""

    def write(self, number: int, value: int) -> None:
        """Sets output `number` (counted among the outputs of `symbols`) at the time advanced to."""
