"""Late transitions by the truth of a simulated body shop: over the actual time they belong to.

Ghosh 2016 (section 3.2) takes "the maximum value of an actual transition time cluster as the true
maximum": a stacker that goes left in 5 s and right in 5.8 s is late after 5 s even below 5.8 s. A
log alone does not tell such times apart, so `runglight.injection` takes the maximum of the whole
transition; the simulation knows. It also knows what a device waited for: such a transition is late
when it comes too long after that.
"""

from bisect import bisect_right
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Literal, NamedTuple

import numpy as np
import numpy.typing as npt

import runglight as rl
from benches.plants import Bodyshop
from runglight.injection import Distribution, InjectionKind, InjectionLabel
from runglight.injection.labels import iso

TICK_NS = 10_000_000
SPACING_NS = 10_000_000_000
MOVED_AT_MOST = 200

Integers = npt.NDArray[np.int64]
_Kind = Literal["own", "wait", "hidden"]


@dataclass(frozen=True)
class Late:
    """The changed log and its labels: which are waits for another device, and which are `hidden`.

    A hidden one took as long as another actual time of its transition: no time tells it.
    """

    log: rl.Log
    labels: list[InjectionLabel]
    waits: frozenset[str]
    hidden: frozenset[str]


@dataclass
class _Room:
    """Times that are taken, per place."""

    taken: defaultdict[str, list[tuple[int, int]]] = field(
        default_factory=lambda: defaultdict(list)
    )

    def take(self, place: str, start: int, end: int) -> bool:
        """Takes a stretch if nothing is near; False where something is."""
        stretches = self.taken[place]
        at = bisect_right(stretches, (end + SPACING_NS, end))
        if at and stretches[at - 1][1] > start - SPACING_NS:
            return False
        stretches.insert(at, (start, end))
        return True


def insert_late(plant: Bodyshop, number: int, over: Distribution, seed: int) -> Late:
    """Makes so many transitions late, at places drawn from all of the log."""
    return _Inserter(plant).insert(number, over, np.random.default_rng(seed))


class _Made(NamedTuple):
    """One late transition, from row `before` to `row`; sorted by when it was due."""

    due: int
    start: int
    end: int
    before: int
    row: int
    kind: _Kind
    size_s: float


class _Inserter:
    def __init__(self, plant: Bodyshop) -> None:
        run = plant.run.watch
        self._run = run
        self._state = 2 * run.signal_index.astype(np.int64) + run.value
        names = [name.split("-", 2) for name in run.signals]
        self._device_of_signal = [f"{group}-{device}" for group, device, _ in names]
        number = {device: n for n, device in enumerate(dict.fromkeys(self._device_of_signal))}
        device = np.array([number[name] for name in self._device_of_signal])[run.signal_index]
        order = np.argsort(device, kind="stable")
        bounds = np.searchsorted(device[order], np.arange(len(number) + 1))
        self._rows = [order[low:high] for low, high in pairwise(bounds)]
        self._device = device
        self._place = np.empty(len(order), dtype=np.int64)
        for rows in self._rows:
            self._place[rows] = np.arange(len(rows))
        self._name = [
            f"{signal}_{'ON' if value else 'OFF'}" for signal in run.signals for value in (0, 1)
        ]
        code = {name: state for state, name in enumerate(self._name)}
        self._ranges: dict[tuple[int, int], tuple[tuple[float, float], ...]] = {
            (code[times.transition[0]], code[times.transition[1]]): times.times_s
            for times in plant.run.cycle_times
            if times.after == "device"
        }
        self._waits = {
            (code[current], code[following]): (
                [code[state] for state in wait.states],
                wait.delays_s,
            )
            for wait in plant.run.triggers
            for current, following in wait.transitions
        }
        by_state = np.argsort(self._state, kind="stable")
        starts = np.searchsorted(self._state[by_state], np.arange(len(self._name) + 1))
        self._times_of_state = (run.time_ns[by_state], starts)
        self._time = run.time_ns.copy()

    def insert(self, number: int, over: Distribution, random: np.random.Generator) -> Late:
        sizes_s = over.draw_s(random, number).tolist()
        room = _Room()
        found: list[_Made] = []
        clean_ns = int(self._run.time_ns[0]) + (self._run.end_ns - int(self._run.time_ns[0])) // 10
        for row in random.permutation(len(self._time)).tolist():
            if len(found) == number:
                break
            if self._run.time_ns[row] < clean_ns:
                continue
            size_ns = round(sizes_s[len(found)] * 1e9 / TICK_NS) * TICK_NS
            made = self._make_late(row, size_ns, room)
            if made is not None:
                found.append(made)
        found.sort()
        labels = []
        ids: dict[str, set[str]] = {"own": set(), "wait": set(), "hidden": set()}
        for at, made in enumerate(found, 1):
            labels.append(self._label(f"T{at:05}", made))
            ids[made.kind].add(labels[-1].id)
        order = np.argsort(self._time, kind="stable")
        run = self._run
        log = rl.Log.from_columns(
            self._time[order], run.signal_index[order], run.value[order], run.signals
        )
        return Late(log, labels, frozenset(ids["wait"]), frozenset(ids["hidden"]))

    def _make_late(self, row: int, size_ns: int, room: _Room) -> _Made | None:
        rows, place = self._rows[self._device[row]], int(self._place[row])
        if place == 0:
            return None
        before = int(rows[place - 1])
        due = self._due(before, row)
        if due is None:
            return None
        due_ns, kind, others = due
        if any(low <= due_ns + size_ns <= high for low, high in others):
            kind = "hidden"
        moves = self._pushed(rows, place, due_ns + size_ns)
        if moves is None:
            return None
        last_ns = max(time for _, time in moves)
        device = self._device_of_signal[self._run.signal_index[row]]
        group = device.partition("-")[0]
        start = int(self._run.time_ns[before])
        if not room.take(device, start, last_ns):
            return None
        if not room.take(group, due_ns, last_ns):
            room.taken[device].remove((start, last_ns))
            return None
        for each, time in moves:
            self._time[each] = time
        return _Made(due_ns, start, last_ns, before, row, kind, size_ns / 1e9)

    def _due(self, before: int, row: int) -> tuple[int, _Kind, list[tuple[int, int]]] | None:
        """When the transition has taken as long as it truly ever does, this time.

        Also whether its time is its own or a wait, and when its other times would have been.
        """
        transition = int(self._state[before]), int(self._state[row])
        time = self._run.time_ns
        if transition in self._waits:
            states, ranges = self._waits[transition]
            since = max(self._last(state, int(time[row])) for state in states)
        elif transition in self._ranges:
            ranges, since = self._ranges[transition], int(time[before])
        else:
            return None
        elapsed_s = (int(time[row]) - since) / 1e9
        # The clock's ticks may cut a time off on both sides.
        of_time = [most for least, most in ranges if least - 0.011 <= elapsed_s <= most + 0.011]
        if not of_time or since <= 0:
            return None
        due_ns = since + round(max(of_time) * 1e9)
        others = [
            (since + round(least * 1e9) - TICK_NS, since + round(most * 1e9) + TICK_NS)
            for least, most in ranges
        ]
        return due_ns, "wait" if transition in self._waits else "own", others

    def _last(self, state: int, time_ns: int) -> int:
        """When a state was entered last, before or at a time; 0 where it was not."""
        times, starts = self._times_of_state
        stretch = times[starts[state] : starts[state + 1]]
        at = int(np.searchsorted(stretch, time_ns, side="right"))
        return int(stretch[at - 1]) if at else 0

    def _pushed(self, rows: Integers, place: int, new_time: int) -> list[tuple[int, int]] | None:
        """The event and those after it: their own times stay, waits take up what they can."""
        moves = [(int(rows[place]), new_time)]
        time = self._run.time_ns
        for before, row in self._pairs(rows, place):
            elapsed = int(time[row]) - int(time[before])
            own = (int(self._state[before]), int(self._state[row])) in self._ranges
            if not own and int(time[row]) >= new_time + 2 * TICK_NS:
                return moves
            new_time += elapsed if own else min(elapsed, 2 * TICK_NS)
            moves.append((row, new_time))
            if len(moves) > MOVED_AT_MOST:
                return None
        return None

    def _pairs(self, rows: Integers, place: int) -> Iterator[tuple[int, int]]:
        for at in range(place + 1, len(rows)):
            yield int(rows[at - 1]), int(rows[at])

    def _label(self, name: str, made: _Made) -> InjectionLabel:
        run = self._run
        group, device, signal = run.signals[run.signal_index[made.row]].split("-", 2)
        current, following = (self._name[self._state[row]] for row in (made.before, made.row))
        return InjectionLabel(
            id=name,
            time=iso(made.due),
            start=iso(made.start),
            end=iso(made.end),
            kind=InjectionKind.LATE,
            group=group,
            device=device,
            signal=signal,
            from_state=current,
            to_state=following,
            size_s=made.size_s,
            description=f"{following} comes {made.size_s:g} s over its actual time",
        )
