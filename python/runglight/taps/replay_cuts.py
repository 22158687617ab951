"""Where the rows of a log may be cut into batches, and what lies between them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from runglight.log.changelog import Log
from runglight.taps.base import Batch, Gap, TapSignal

MOST_ROWS = 8_192
"""Rows of one batch, but for more rows of one time."""
_CLASS_OF = {"I": "input", "E": "input", "Q": "output", "A": "output", "M": "memory"}


@dataclass(frozen=True, slots=True)
class _Declared:
    """A gap of the log, and the first row after it."""

    gap: Gap
    row: int


class ReplayCuts:
    """A log and how far it has been handed out."""

    def __init__(self, log: Log) -> None:
        times, indices, values = log.columns()
        self._time_ns: npt.NDArray[np.int64] = np.asarray(times, np.int64)
        self._index: npt.NDArray[np.uint32] = np.asarray(indices, np.uint32)
        self._value: npt.NDArray[np.int64] = np.asarray(values, np.int64)
        self._signals = len(log.signals)
        self._gaps = [
            _Declared(
                Gap(start, end, "the log declares a gap"),
                int(np.searchsorted(self._time_ns, start, "right")),
            )
            for start, end in log.engine.gaps
        ]
        self._row = 0

    @property
    def next_ns(self) -> int | None:
        """Time of the next row; None after the last."""
        return int(self._time_ns[self._row]) if self._row < len(self._time_ns) else None

    def quiet_until_ns(self, reached_ns: int) -> int:
        """How far it is known, at `reached_ns`, that nothing happened before the next row."""
        until_ns = reached_ns if self.next_ns is None else min(reached_ns, self.next_ns - 1)
        gaps = self._marks()
        return min([until_ns, *(gap.start_ns for gap in gaps)])

    def take(self, reached_ns: int | None) -> Batch:
        """The next rows, up to `reached_ns` (None: as many as a batch holds)."""
        row, times = self._row, self._time_ns
        most = min(row + MOST_ROWS, len(times))
        if reached_ns is not None:
            most = min(most, int(np.searchsorted(times, reached_ns, "right")))
        # Rows of one time stay together, and what starts with an image is that image.
        same_ns = times[max(most - 1, row)]
        image_stop = self._image_stop()
        stop = image_stop or int(np.searchsorted(times, same_ns, "right"))
        stop = min([stop, *(declared.row for declared in self._gaps if declared.row > row)])
        marks = self._marks()
        self._row = stop
        return Batch(
            until_ns=int(times[stop - 1]),
            time_ns=times[row:stop],
            signal_index=self._index[row:stop],
            value=self._value[row:stop],
            marks=marks,
            image=image_stop is not None,
        )

    def last(self) -> Batch:
        """The empty batch at the end of the log."""
        marks = self._marks()
        ends = [gap.end_ns for gap in marks]
        if len(self._time_ns):
            ends.append(int(self._time_ns[-1]))
        return Batch(until_ns=max(ends, default=0), marks=marks)

    def _marks(self) -> tuple[Gap, ...]:
        return tuple(declared.gap for declared in self._gaps if declared.row == self._row)

    def _image_stop(self) -> int | None:
        """The end of the rows of one time, where they begin a stretch and tell every signal."""
        if self._row != 0 and not self._marks():
            return None
        stop = int(np.searchsorted(self._time_ns, self._time_ns[self._row], "right"))
        told = np.unique(self._index[self._row : stop])
        return stop if len(told) == self._signals == stop - self._row else None


def signals_of(log: Log) -> list[TapSignal]:
    """The log's signals; what a log does not tell is guessed from names and values."""
    _, indices, values = log.columns()
    signals = log.signals
    least = _extremes(np.minimum, indices, values, len(signals))
    most = _extremes(np.maximum, indices, values, len(signals))
    return [
        TapSignal(name, name, _type(low, high), _class(name))
        for name, low, high in zip(signals, least.tolist(), most.tolist(), strict=True)
    ]


def _extremes(
    extreme: np.ufunc, indices: Sequence[int], values: Sequence[int], signals: int
) -> npt.NDArray[np.int64]:
    found = np.zeros(signals, np.int64)
    extreme.at(found, indices, values)
    return found


def _type(low: int, high: int) -> str:
    if low >= 0 and high <= 1:
        return "BOOL"
    for bits, name in ((16, "INT"), (32, "DINT")):
        if -(1 << bits - 1) <= low and high < 1 << bits - 1:
            return name
    return "LINT"


def _class(name: str) -> str:
    is_address = name.startswith("%") or name[1:2].isdigit()
    letter = name.removeprefix("%")[:1]
    return _CLASS_OF.get(letter, "input") if is_address else "input"
