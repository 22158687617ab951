"""The log of a running plant: begins with the whole image, as a tap does; ends with a sample."""

from collections.abc import Sequence

import numpy as np

from runglight.plants.run import PlantRun
from runglight.plants.running import RunningPlant


class ImageLog:
    """Collects what a logger at a plant's PLC sees, from its start on."""

    def __init__(self, plant: RunningPlant, start_ns: int) -> None:
        self._plant = plant
        self._start_ns = start_ns
        self._first: set[int] = set()
        self._time_ns: list[int] = []
        self._signal: list[int] = []
        self._value: list[int] = []
        plant.on_change(self._row)

    def _row(self, time_ns: int, number: int, value: int) -> None:
        if time_ns == self._start_ns:
            self._first.add(number)
        self._time_ns.append(time_ns)
        self._signal.append(number)
        self._value.append(value)

    def run(self, end_ns: int, signals: Sequence[str]) -> PlantRun:
        """The log so far, its signals called `signals`, closed by a sample at its end."""
        off = [number for number in range(len(signals)) if number not in self._first]
        rows = zip(reversed(self._signal), reversed(self._value), strict=True)
        last = next((value for number, value in rows if not number), 0)
        return PlantRun(
            np.array([self._start_ns] * len(off) + self._time_ns + [end_ns], dtype=np.int64),
            np.array([*off, *self._signal, 0], dtype=np.uint32),
            np.array([0] * len(off) + self._value + [last], dtype=np.int64),
            signals=tuple(signals),
            labels=self._plant.labels(),
            end_ns=end_ns,
        )
