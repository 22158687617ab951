"""Whether a changed stretch of a device's chain departs from everything the clean log does.

Events of one scan have no order, and a watcher may try all of them before it calls a transition
unknown. So a stretch departs only where no order of the events of its scans is known throughout.
"""

from collections.abc import Set
from typing import NamedTuple

ORDERS_AT_MOST = 6
"""Largest number of events of one scan whose orders are tried."""


class Step(NamedTuple):
    """One event of a device."""

    time: int
    state: int


class Departure(NamedTuple):
    """The first transition that the clean log never makes."""

    time: int
    current: int
    next: int


def first_departure(
    before: list[int], steps: list[Step], known: Set[int], states: int, window_ns: int
) -> Departure | None:
    """Follows the steps from the events of the scan `before`; None where a known way remains.

    `known` holds transitions as `current * states + next`; steps nearer than `window_ns` are of
    one scan. The departure is the first unknown transition as the events stand.
    """
    alive = frozenset(before)
    for first, end in _scans(steps, window_ns):
        scan = tuple(step.state for step in steps[first:end])
        if len(scan) > ORDERS_AT_MOST:
            return None
        alive = frozenset(last for state in alive for last in _ends(state, scan, known, states))
        if not alive:
            return _first_unknown(before[-1], steps[:end], known, states)
    return None


def _scans(steps: list[Step], window_ns: int) -> list[tuple[int, int]]:
    bounds = [0]
    for index in range(1, len(steps)):
        apart = steps[index].time - steps[index - 1].time
        if apart > 0 and apart >= window_ns:
            bounds.append(index)
    return list(zip(bounds, [*bounds[1:], len(steps)], strict=True))


def _ends(state: int, scan: tuple[int, ...], known: Set[int], states: int) -> set[int]:
    """States in which the events of one scan can end by known transitions."""
    if not scan:
        return {state}
    ends: set[int] = set()
    for index, following in enumerate(scan):
        if state * states + following in known:
            ends |= _ends(following, scan[:index] + scan[index + 1 :], known, states)
    return ends


def _first_unknown(
    current: int, steps: list[Step], known: Set[int], states: int
) -> Departure | None:
    for step in steps:
        if current * states + step.state not in known:
            return Departure(step.time, current, step.state)
        current = step.state
    return None
