"""The truth about the cell's faults: when each began, and the row that first shows it."""

from runglight.plants.agenda import NS_PER_S
from runglight.plants.cell.symbols import SYMBOLS
from runglight.plants.faults import FaultDescription, FaultKind


class Showing:
    """Reads the rows of a log one after the other for the first that shows a fault.

    A fault that stops the line is shown by the last row there is, if that is its `last_state`.
    """

    def __init__(self, fault: FaultDescription) -> None:
        self.shown_ns: int | None = None
        self.observed_s: float | None = None
        self._fault = fault
        self._before: tuple[str, int] | None = None

    def row(self, time_ns: int, number: int, value: int, began_ns: int | None) -> None:
        """Takes the next row; `began_ns` is when the fault began, None while it has not."""
        fault, symbol = self._fault, SYMBOLS[number]
        if fault.kind is FaultKind.PART_PATTERN:
            return
        state = f"{symbol.name}_{'ON' if value else 'OFF'}"
        began = began_ns is not None and time_ns >= began_ns
        if fault.faulty is None:
            self.shown_ns = time_ns if began and state == fault.last_state else None
            return
        if symbol.device != fault.device or self.shown_ns is not None:
            return
        if self._before is not None and began and (self._before[0], state) == fault.faulty:
            self.shown_ns = time_ns
            self.observed_s = (time_ns - self._before[1]) / NS_PER_S
        self._before = state, time_ns
