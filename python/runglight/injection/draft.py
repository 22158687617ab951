"""A log being changed: what moves, what goes, what comes; the columns of the result."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from runglight.injection.departure import Departure, Step, first_departure
from runglight.plants.run import Columns

if TYPE_CHECKING:
    from runglight.injection.chains import Chains, Flags, Integers, Rows
    from runglight.injection.kinds import InjectionKind
    from runglight.injection.placement import Placement
    from runglight.injection.room import Room

CARRIED_AT_MOST = 500
"""A change of time that this many events do not absorb is not made."""


@dataclass(frozen=True, slots=True)
class Truth:
    """A label before the stalls have moved it: times on the log's own clock."""

    kind: InjectionKind
    group: int
    device: int | None
    signal: int | None
    time: int
    start: int
    end: int
    current: int | None
    next: int | None
    description: str
    size_s: float | None = None
    share: float | None = None


@dataclass(slots=True)
class Draft:
    """Everything done so far. Positions are those of the chains."""

    rows: Rows
    chains: Chains
    placement: Placement
    room: Room
    tick_ns: int
    """Resolution of the log: all times of the result stay on it."""
    window_ns: int
    """Events nearer than this are of one scan."""
    clean_until_ns: int
    time: Integers = field(init=False)
    """Per position: its time so far, but for the pauses of its group."""
    truths: list[Truth] = field(default_factory=list)
    _dropped: list[int] = field(default_factory=list)
    _swapped: list[tuple[int, int]] = field(default_factory=list)
    _inserted: list[tuple[int, int, int, int]] = field(default_factory=list)
    _pauses: dict[int, list[tuple[int, int]]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.time = self.chains.time.copy()

    def group_at(self, position: int) -> int:
        """The group of an event."""
        return int(self.placement.group_of[self.chains.device_at(position)])

    def on_clock(self, seconds: float) -> int:
        """Nanoseconds on the log's resolution, at least one tick."""
        return max(1, round(seconds * 1e9 / self.tick_ns)) * self.tick_ns

    def open(self) -> Flags:
        """Per position: something is known before it, and the result will hold it."""
        chains = self.chains
        found: Flags = (chains.transition >= 0) & (chains.time >= self.clean_until_ns)
        cut_ns = self.cut_ns()
        for group in self._pauses:
            for device in np.flatnonzero(self.placement.group_of == group).tolist():
                stretch = slice(int(chains.start[device]), int(chains.start[device + 1]))
                found[stretch] &= self.moved_all(group, chains.time[stretch]) <= cut_ns
        return found

    def linked(self, position: int) -> bool:
        """True where the event before is known."""
        return position < len(self.chains.transition) and self.chains.transition[position] >= 0

    def after(self, position: int) -> int:
        """The next event of the device, or the event itself where none is known."""
        return position + 1 if self.linked(position + 1) else position

    def free(self, device: int, start: int, end: int, context: tuple[int, int]) -> bool:
        """True where a fault of a device finds room, and what it is judged by is untouched."""
        group = int(self.placement.group_of[device])
        return self.room.free(("group", group), start, end) and self.room.free(
            ("device", device), *context
        )

    def take(self, device: int, start: int, end: int, context: tuple[int, int]) -> None:
        """Keeps others away."""
        self.room.take(("group", int(self.placement.group_of[device])), start, end)
        self.room.take(("device", device), *context)

    # What can be done.

    def drop(self, position: int) -> None:
        """Leaves an event out."""
        self._dropped.append(position)

    def swap(self, position: int) -> None:
        """Lets an event and the one before change places."""
        before = position - 1
        self.time[before], self.time[position] = self.time[position], self.time[before]
        self._swapped.append((before, position))

    def insert(self, time: int, state: int, after: int) -> None:
        """Adds an event; among rows of its time it stands after the given position."""
        signal, value = self.chains.signal_value(state)
        self._inserted.append((time, signal, value, 2 * int(self.chains.row[after]) + 1))

    def pause(self, group: int, time: int, nanoseconds: int) -> None:
        """Moves everything of a group from `time` on, to later or (below zero) to earlier.

        The next gap takes it up again.
        """
        self._pauses.setdefault(group, []).append((time, nanoseconds))

    def pause_fits(self, group: int, time: int, nanoseconds: int) -> bool:
        """True where the next gap is long enough to take the group's pauses up."""
        for start, end in self.rows.gaps:
            if start >= time:
                before = max((stop for _, stop in self.rows.gaps if stop <= time), default=None)
                total = sum(
                    length
                    for at, length in self._pauses.get(group, [])
                    if at < start and (before is None or at >= before)
                )
                return total + nanoseconds < end - start
        return True

    def carried(self, position: int, new_time: int) -> list[tuple[int, int]] | None:
        """Moves an event; what follows in its device moves only as far as it must.

        A following transition takes no less than its true minimum and no more than its true
        maximum, so that it departs in nothing, and the first one with time to spare absorbs the
        rest. Returns positions and times; None where the log ends or breaks before that.
        """
        chains = self.chains
        end = int(chains.start[chains.device_at(position) + 1])
        moves = [(position, new_time)]
        while position + 1 < end:
            position += 1
            transition = int(chains.transition[position])
            if transition < 0 or len(moves) > CARRIED_AT_MOST:
                return None
            old = int(self.time[position])
            earliest = new_time + int(chains.minimum[transition])
            latest = new_time + int(chains.maximum[transition])
            new_time = min(max(old, earliest), latest)
            if new_time == old:
                return moves
            moves.append((position, new_time))
        return moves

    def departure(
        self, first: int, last: int, steps: list[Step]
    ) -> tuple[Departure, tuple[int, int]] | None:
        """What shows when `steps` take the place of positions `first` to `last`.

        Returns the first transition the clean log never makes, and the stretch of time it was
        judged by.
        """
        chains = self.chains
        begin = first
        while self.linked(begin) and self._same_scan(begin):
            begin -= 1
        if not self.linked(begin):
            return None
        oldest = begin - 1
        while self.linked(oldest) and self._same_scan(oldest):
            oldest -= 1
        end = last + 1
        if not self.linked(end):
            return None
        while self.linked(end + 1) and self._same_scan(end + 1):
            end += 1
        around = [
            *(self._step(position) for position in range(begin, first)),
            *steps,
            *(self._step(position) for position in range(last + 1, end + 1)),
        ]
        before: list[int] = chains.state[oldest:begin].tolist()
        found = first_departure(before, around, chains.known, chains.states, self.window_ns)
        if found is None:
            return None
        return found, (int(chains.time[oldest]), int(chains.time[end]))

    def step(self, position: int) -> Step:
        """An event as the clean log has it."""
        return self._step(position)

    def _step(self, position: int) -> Step:
        return Step(int(self.chains.time[position]), int(self.chains.state[position]))

    def _same_scan(self, position: int) -> bool:
        apart = int(self.chains.time[position] - self.chains.time[position - 1])
        return apart == 0 or apart < self.window_ns

    # The result.

    def moved(self, group: int, time: int) -> int:
        """Where a time of a group ends up after its pauses."""
        return int(self.moved_all(group, np.array([time], dtype=np.int64))[0])

    def moved_all(self, group: int, times: Integers) -> Integers:
        """Where times of a group end up after its pauses."""
        at, shift = self._shifts(group)
        moved: Integers = times + np.concatenate([[0], shift])[np.searchsorted(at, times, "right")]
        return moved

    def cut_ns(self) -> int:
        """Where the result ends: a group that has paused less must not seem to fall silent."""
        last = int(self.rows.time[-1])
        groups = range(len(self.placement.groups))
        return min((self.moved(group, last) for group in groups), default=last)

    def _shifts(self, group: int) -> tuple[Integers, Integers]:
        pauses = sorted(self._pauses.get(group, []))
        at = np.array([time for time, _ in pauses], dtype=np.int64)
        length = np.array([length for _, length in pauses], dtype=np.int64)
        segment = np.searchsorted([end for _, end in self.rows.gaps], at, side="right")
        shift = np.cumsum(length)
        # A gap takes all pauses before it up.
        for number, (_, end) in enumerate(self.rows.gaps):
            so_far = shift[segment <= number][-1:]
            after = segment > number
            if len(so_far):
                place = int(after.argmax()) if after.any() else len(at)
                shift[after] -= so_far
                at = np.insert(at, place, end)
                shift = np.insert(shift, place, 0)
                segment = np.insert(segment, place, number + 1)
        return at, shift

    def columns(self) -> Columns:
        """The changed log in time order."""
        rows, chains = self.rows, self.chains
        time = rows.time.copy()
        time[chains.row] = self.time
        key = 2 * np.arange(len(time), dtype=np.int64)
        for before, position in self._swapped:
            a, b = chains.row[before], chains.row[position]
            key[a], key[b] = key[b], key[a]
        kept = np.ones(len(time), dtype=np.bool_)
        kept[chains.row[self._dropped]] = False
        sample = ~rows.event & ~rows.quiet
        inserted = np.array(self._inserted, dtype=np.int64).reshape(-1, 4)
        clean_time = np.concatenate([rows.time[kept], inserted[:, 0]])
        time = np.concatenate([time[kept], inserted[:, 0]])
        signal = np.concatenate([rows.signal[kept], inserted[:, 1]])
        value = np.concatenate([rows.value[kept], inserted[:, 2]])
        key = np.concatenate([key[kept], inserted[:, 3]])
        sample = np.concatenate([sample[kept], np.zeros(len(inserted), dtype=np.bool_)])
        for group in self._pauses:
            of_group = self.placement.group_of[self.placement.device_of[signal]] == group
            time[of_group] += self.moved_all(group, clean_time[of_group]) - clean_time[of_group]
        order = np.lexsort((key, time))
        if self._pauses:
            order = order[: int(np.searchsorted(time[order], self.cut_ns(), side="right"))]
        time, signal, value, sample = time[order], signal[order], value[order], sample[order]
        _refresh(signal, value, sample)
        return Columns(time, signal.astype(np.uint32), value)


def _refresh(signal: Any, value: Any, sample: Any) -> None:
    """Samples say what the signal's last event said."""
    if not sample.any():
        return
    by_signal = np.argsort(signal, kind="stable")
    carries = np.where(sample[by_signal], -1, np.arange(len(by_signal)))
    latest = np.maximum.accumulate(carries)
    known = latest >= 0
    known[known] = signal[by_signal[latest[known]]] == signal[by_signal[known]]
    value[by_signal[known]] = value[by_signal[latest[known]]]
