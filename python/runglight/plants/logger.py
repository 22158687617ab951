"""The data logger: watches a PLC's two images and writes a row whenever a signal changes."""

from collections.abc import Sequence

import numpy as np

from runglight.plants.run import Columns


class ChangeLogger:
    """Writes changes, inputs before outputs within one scan (the order a tap sees them in).

    The first sample is the image at the start: only the signals that are ON are written, as the
    logger of Ghosh 2016 does (section 2.3.1: no BACKWARD_OFF in the first device cycle).
    """

    def __init__(self, input_numbers: Sequence[int], output_numbers: Sequence[int]) -> None:
        self._numbers = (*input_numbers, *output_numbers)
        self._image: tuple[bool, ...] = (False,) * len(self._numbers)
        self._time_ns: list[int] = []
        self._signal: list[int] = []
        self._value: list[int] = []

    def sample(self, time_ns: int, inputs: tuple[bool, ...], outputs: tuple[bool, ...]) -> None:
        """Looks at the images once and writes what differs from the last look."""
        image = inputs + outputs
        if image == self._image:
            return
        for number, old, new in zip(self._numbers, self._image, image, strict=True):
            if old != new:
                self._write(time_ns, number, new)
        self._image = image

    def close(self, time_ns: int) -> None:
        """Repeats the first signal's value: a silent line still shows that time went on."""
        first = self._numbers.index(0)
        self._write(time_ns, 0, self._image[first])

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

    def _write(self, time_ns: int, number: int, value: bool) -> None:
        self._time_ns.append(time_ns)
        self._signal.append(number)
        self._value.append(int(value))
