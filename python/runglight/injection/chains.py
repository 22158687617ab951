"""The device chains of a log as columns: events with their predecessors, transitions with times."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from collections.abc import Sequence

    from runglight.injection.placement import Placement
    from runglight.log.changelog import Log

Integers = npt.NDArray[np.int64]
Flags = npt.NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Rows:
    """The rows of one log, its signals numbered as in the placement."""

    time: Integers
    signal: Integers
    value: Integers
    event: Flags
    """The row changes its signal's value."""
    quiet: Flags
    """The row is no event and no sample: it belongs to the image at a start or after a gap."""
    segment: Integers
    """Number of gaps before the row."""
    gaps: tuple[tuple[int, int], ...]


@dataclass(frozen=True, slots=True)
class Chains:
    """All events in the order of device, time, and place in the scan.

    A *position* counts into these columns; the events of device `d` are `start[d]` to
    `start[d + 1]`. They are those of the log alone; transitions are also those of the references.
    """

    row: Integers
    time: Integers
    state: Integers
    start: Integers
    transition: Integers
    """The transition that leads to the event; -1 where nothing is known before it."""
    segment: Integers
    values: Integers
    """All values that occur; a state is `signal * len(values) + index of the value`."""
    states: int
    codes: Integers
    """Per transition: `from * states + to`."""
    count: Integers
    minimum: Integers
    maximum: Integers
    known: frozenset[int]
    """Codes of all transitions, also those in the order of the file where scans have ties."""

    def signal_value(self, state: int) -> tuple[int, int]:
        """Signal and value of a state."""
        signal, value = divmod(state, len(self.values))
        return signal, int(self.values[value])

    def state_of(self, signal: int, value: int) -> int:
        """The state of a signal with a value that occurs."""
        return signal * len(self.values) + int(np.searchsorted(self.values, value))

    def device_at(self, position: int) -> int:
        """The device of an event."""
        return int(np.searchsorted(self.start, position, side="right")) - 1


def rows_of(log: Log, placement: Placement) -> Rows:
    """Tells events from samples, as the engine does."""
    time, index, value = log.columns()
    number = {symbol: n for n, symbol in enumerate(placement.symbols)}
    numbers = np.array([number[symbol] for symbol in log.signals], dtype=np.int64)
    signal = numbers[index] if len(index) else np.zeros(0, dtype=np.int64)
    gaps = tuple(log.engine.gaps)
    ends = np.array([end for _, end in gaps], dtype=np.int64)
    segment = np.searchsorted(ends, time, side="right").astype(np.int64)

    quiet = np.zeros(len(time), dtype=np.bool_)
    for at, (first_time, is_image) in _first_times(time, value, ends):
        if is_image:
            quiet[at : int(np.searchsorted(time, first_time, side="right"))] = True
    by_signal = np.argsort(signal, kind="stable")
    changed = np.ones(len(time), dtype=np.bool_)
    same_signal = signal[by_signal][1:] == signal[by_signal][:-1]
    same_value = value[by_signal][1:] == value[by_signal][:-1]
    changed[by_signal[1:]] = ~(same_signal & same_value)
    return Rows(time, signal, value, changed & ~quiet, quiet, segment, gaps)


def _first_times(
    time: Integers, value: Integers, gap_ends: Integers
) -> list[tuple[int, tuple[int, bool]]]:
    """First row and time of each stretch, and whether it is an image rather than events."""
    if not len(time):
        return []
    # Values 0 at the very first time: nothing can change to 0 before it was anything else.
    of_first = int(np.searchsorted(time, time[0], side="right"))
    found = [(0, (int(time[0]), bool((value[:of_first] == 0).any())))]
    for end in gap_ends.tolist():
        at = int(np.searchsorted(time, end, side="left"))
        if at < len(time):
            found.append((at, (int(time[at]), True)))
    return found


def chains_of(rows: Rows, references: Sequence[Rows], placement: Placement) -> Chains:
    """Builds the chains; transitions and their times are those of the log and the references."""
    everything = [rows, *references]
    values = np.unique(np.concatenate([np.unique(each.value) for each in everything]))
    states = len(placement.symbols) * len(values)
    own = _chain(rows, placement, values)
    all_codes, all_times = [], []
    known: set[int] = set()
    for each in everything:
        chain = own if each is rows else _chain(each, placement, values)
        linked = np.flatnonzero(chain.linked)
        found = chain.state[linked - 1] * states + chain.state[linked]
        known.update(np.unique(found).tolist())
        known.update(_codes_in_file_order(each, chain, placement, states))
        # What is ON when the log begins is written at its first time: no time of a transition.
        timed = chain.time[linked] > each.time[0]
        all_codes.append(found[timed])
        all_times.append((chain.time[linked] - chain.time[linked - 1])[timed])
        chain.linked[linked[~timed]] = False
    codes, inverse = np.unique(np.concatenate(all_codes), return_inverse=True)
    times = np.concatenate(all_times)
    minimum = np.full(len(codes), np.iinfo(np.int64).max)
    maximum = np.zeros(len(codes), dtype=np.int64)
    np.minimum.at(minimum, inverse, times)
    np.maximum.at(maximum, inverse, times)
    transition = np.full(len(own.row), -1, dtype=np.int64)
    transition[own.linked] = inverse[: int(own.linked.sum())]
    return Chains(
        row=own.row,
        time=own.time,
        state=own.state,
        start=np.searchsorted(own.device, np.arange(len(placement.devices) + 1)).astype(np.int64),
        transition=transition,
        segment=rows.segment[own.row],
        values=values,
        states=states,
        codes=codes,
        count=np.bincount(inverse, minlength=len(codes)),
        minimum=minimum,
        maximum=maximum,
        known=frozenset(known),
    )


@dataclass(frozen=True, slots=True)
class _Chain:
    row: Integers
    time: Integers
    state: Integers
    device: Integers
    linked: Flags


def _chain(rows: Rows, placement: Placement, values: Integers) -> _Chain:
    events = np.flatnonzero(rows.event)
    time, signal = rows.time[events], rows.signal[events]
    if (time[1:] == time[:-1]).any():
        order = np.lexsort((placement.rank[signal], time))
        events, time, signal = events[order], time[order], signal[order]
    return _in_devices(rows, placement, values, events)


def _in_devices(rows: Rows, placement: Placement, values: Integers, events: Integers) -> _Chain:
    device = placement.device_of[rows.signal[events]]
    order = np.argsort(device, kind="stable")
    events, device = events[order], device[order]
    state = rows.signal[events] * len(values) + np.searchsorted(values, rows.value[events])
    linked = np.zeros(len(events), dtype=np.bool_)
    linked[1:] = (device[1:] == device[:-1]) & (
        rows.segment[events[1:]] == rows.segment[events[:-1]]
    )
    return _Chain(events, rows.time[events], state, device, linked)


def _codes_in_file_order(rows: Rows, chain: _Chain, placement: Placement, states: int) -> list[int]:
    """Transitions as `--timing plat` sees them, which leaves the events of a scan as they came."""
    order = np.lexsort((chain.row, chain.device))
    moved = np.flatnonzero(order != np.arange(len(order)))
    if not len(moved):
        return []
    state, linked = chain.state[order], chain.linked
    near = np.unique(np.clip(np.concatenate([moved, moved + 1]), 1, len(order) - 1))
    near = near[linked[near]]
    found: list[int] = np.unique(state[near - 1] * states + state[near]).tolist()
    return found
