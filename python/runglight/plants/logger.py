"""The data logger: watches a PLC's images and writes a row whenever a signal changes."""

from collections.abc import Callable, Sequence
from itertools import compress, count
from operator import ne

import numpy as np

from runglight.plants.run import Columns

WriteRow = Callable[[int, int, int], None]
"""Takes a row: time in nanoseconds, the signal's number, its new value."""


class ChangeDetector:
    """Finds changes, inputs before outputs within one scan (the order a tap sees them in).

    The first sample is the image at the start: only the signals that are ON are written, as the
    logger of Ghosh 2016 does (section 2.3.1: no BACKWARD_OFF in the first device cycle).
    """

    def __init__(
        self,
        input_numbers: Sequence[int],
        output_numbers: Sequence[int],
        write: WriteRow,
        memory_numbers: Sequence[int] = (),
    ) -> None:
        self._numbers = (*input_numbers, *output_numbers, *memory_numbers)
        self._image: tuple[int, ...] = (False,) * len(self._numbers)
        self._write = write

    def sample(
        self,
        time_ns: int,
        inputs: tuple[int, ...],
        outputs: tuple[int, ...],
        memory: tuple[int, ...] = (),
    ) -> None:
        """Looks at the images once and writes what differs from the last look."""
        image = inputs + outputs + memory
        if image == self._image:
            return
        for place in compress(count(), map(ne, self._image, image)):
            self._write(time_ns, self._numbers[place], int(image[place]))
        self._image = image

    def last_value(self, number: int) -> int:
        """What the signal was when last looked at."""
        return int(self._image[self._numbers.index(number)])


class ChangeLogger(ChangeDetector):
    """Keeps every row."""

    def __init__(self, input_numbers: Sequence[int], output_numbers: Sequence[int]) -> None:
        super().__init__(input_numbers, output_numbers, self._keep)
        self._time_ns: list[int] = []
        self._signal: list[int] = []
        self._value: list[int] = []

    def close(self, time_ns: int) -> None:
        """Repeats the first signal's value: a silent line still shows that time went on."""
        self._keep(time_ns, 0, self.last_value(0))

    @property
    def last_change_ns(self) -> int | None:
        """Time of the last row; None before the first."""
        return self._time_ns[-1] if self._time_ns else None

    def columns(self) -> Columns:
        """Everything written so far."""
        return Columns(
            np.array(self._time_ns, dtype=np.int64),
            np.array(self._signal, dtype=np.uint32),
            np.array(self._value, dtype=np.int64),
        )

    def _keep(self, time_ns: int, number: int, value: int) -> None:
        self._time_ns.append(time_ns)
        self._signal.append(number)
        self._value.append(value)
