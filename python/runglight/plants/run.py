"""What one run of a simulated plant gives: its change log, and the truth about its faults."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from runglight.plants.faults import FaultLabel
from runglight.plants.symbols import Symbol


class Columns(NamedTuple):
    """A change log as three columns of one length."""

    time_ns: npt.NDArray[np.int64]
    signal_index: npt.NDArray[np.uint32]
    value: npt.NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class PlantRun:
    """The change log of one run, rows in time order, and the labels of what was done to it.

    `signal_index` counts into `signals` (full names). The last row, at `end_ns`, is a sample: it
    repeats a value and only says that time went on until then.
    """

    time_ns: npt.NDArray[np.int64]
    signal_index: npt.NDArray[np.uint32]
    value: npt.NDArray[np.int64]
    signals: tuple[str, ...]
    labels: tuple[FaultLabel, ...]
    end_ns: int
    symbols: tuple[Symbol, ...] = ()
    """The symbol table, where it is not the same in every run of the plant."""
