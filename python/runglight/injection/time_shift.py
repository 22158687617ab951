"""Shifted time probabilities: over a period, a transition takes its several times in other shares.

The whole group waits with the transition where that leaves every other device within its true
limits; else the device alone is moved, and its later waits absorb it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from runglight.injection.chains import Integers
from runglight.injection.draft import Draft, Truth
from runglight.injection.kinds import InjectionKind
from runglight.injection.plan import InjectionPlan

LEAST_SHARE = 0.1
"""Both times of a transition must have at least this share in the clean log."""
LEAST_PASSES = 20
OUTLIERS = 20
"""One in so many times, at either end, does not count when two times are told apart."""
ACCEPTED = 0.75
"""Part of the wanted change that a period must reach."""


@dataclass(frozen=True, slots=True)
class TwoTimes:
    """A transition with two clearly different times."""

    positions: Integers
    times: Integers
    border: int
    """Times up to here are short, those above long."""
    least: int
    most: int
    """Below and above lie outliers."""

    def of(self, long: bool) -> Integers:
        """All long, or all short times, but for outliers."""
        usual = (self.times >= self.least) & (self.times <= self.most)
        found: Integers = self.times[usual & ((self.times > self.border) == long)]
        return found


def inject_time_shifts(draft: Draft, plan: InjectionPlan, random: np.random.Generator) -> int:
    """Shifts the times of `plan.time_shifts` transitions; returns how many were possible."""
    done: set[int] = set()
    transitions = random.permutation(_with_two_times(draft)).tolist()
    # A group that waits together is how machines do it; a device on its own is second best.
    for together in (True, False):
        for transition in transitions:
            if len(done) == plan.time_shifts:
                return len(done)
            if transition in done:
                continue
            truth = _shift(draft, transition, plan, random, together=together)
            if truth is not None:
                draft.truths.append(truth)
                done.add(transition)
    return len(done)


def _with_two_times(draft: Draft) -> Integers:
    """Transitions whose times fall apart: the widest gap is wider than what lies on either side."""
    chains = draft.chains
    positions = np.flatnonzero(chains.transition >= 0)
    if not len(positions):
        return np.zeros(0, dtype=np.int64)
    transition = chains.transition[positions]
    times = chains.time[positions] - chains.time[positions - 1]
    order = np.lexsort((times, transition))
    transition, times = transition[order], times[order]
    starts = np.searchsorted(transition, np.arange(len(chains.codes)))
    ends = np.searchsorted(transition, np.arange(len(chains.codes)), side="right")
    found = []
    for each in np.flatnonzero(ends - starts >= LEAST_PASSES).tolist():
        ordered = times[starts[each] : ends[each]]
        high = _border(ordered)
        # A few outliers on either side do not make the two times unclear.
        few = len(ordered) // OUTLIERS
        gap = ordered[high] - ordered[high - 1]
        if (
            gap > ordered[high - 1] - ordered[few]
            and gap > ordered[-1 - few] - ordered[high]
            and gap > max(draft.window_ns, draft.tick_ns)
        ):
            found.append(each)
    return np.array(found, dtype=np.int64)


def _border(ordered: Integers) -> int:
    """Where the long times begin: after the widest gap that leaves each side its least share."""
    least = max(1, round(LEAST_SHARE * len(ordered)))
    return least + int(np.diff(ordered)[least - 1 : len(ordered) - least].argmax())


def _two_times(draft: Draft, transition: int) -> TwoTimes:
    chains = draft.chains
    positions = np.flatnonzero(chains.transition == transition)
    times = chains.time[positions] - chains.time[positions - 1]
    ordered = np.sort(times)
    few = len(ordered) // OUTLIERS
    border = int(ordered[_border(ordered) - 1])
    return TwoTimes(positions, times, border, int(ordered[few]), int(ordered[-1 - few]))


def _shift(
    draft: Draft,
    transition: int,
    plan: InjectionPlan,
    random: np.random.Generator,
    *,
    together: bool,
) -> Truth | None:
    chains = draft.chains
    both = _two_times(draft, transition)
    long_share = float((both.times > both.border).mean())
    later = np.flatnonzero(chains.time[both.positions] >= draft.clean_until_ns)
    if len(later) < LEAST_PASSES:
        return None
    passes = min(plan.shift_passes, len(later))
    first = int(random.integers(0, len(later) - passes + 1))
    period = later[first : first + passes]
    device = chains.device_at(int(both.positions[0]))
    group = int(draft.placement.group_of[device])
    begin = int(chains.time[both.positions[period[0]] - 1])
    end = int(chains.time[both.positions[period[-1]]])
    if not room_for_shift(draft, device, begin, end):
        return None
    # Towards the times that are not the rule, so that the change can be as large as wanted.
    for long in sorted((True, False), key=lambda long: long_share if long else 1 - long_share):
        share = long_share if long else 1 - long_share
        to_change = random.permutation(period[(both.times[period] > both.border) != long])
        wanted = max(0, round((share + plan.shift_by) * passes) - (passes - len(to_change)))
        least = (share + ACCEPTED * plan.shift_by) * passes - (passes - len(to_change))
        if together:
            waits = _waits(draft, both, to_change, wanted, long=long, random=random)
            changed = len(waits)
            if not changed or changed < least:
                continue
            for time, length in waits:
                draft.pause(group, time, length)
                draft.room.take(("group", group), *_stretch(time, length))
        else:
            changed, last, times = _alone(draft, both, to_change[:wanted], long, random)
            if not changed or changed < least or not room_for_shift(draft, device, begin, last):
                draft.time[chains.start[device] : chains.start[device + 1]] = times
                continue
            end = max(end, last)
        draft.room.take(("device", device), begin, end)
        draft.room.take(("shift", group), begin, end)
        current, following = divmod(int(chains.codes[transition]), chains.states)
        reached = (passes - len(to_change) + changed) / passes
        return Truth(
            kind=InjectionKind.TIME_SHIFT,
            group=group,
            device=device,
            signal=chains.signal_value(following)[0],
            time=begin,
            start=begin,
            end=end,
            current=current,
            next=following,
            share=reached - share,
            description=(
                f"over {passes} passes, {reached:.0%} of the times are "
                f"{'above' if long else 'at most'} {both.border / 1e9:g} s instead of {share:.0%}"
            ),
        )
    return None


def room_for_shift(draft: Draft, device: int, begin: int, end: int) -> bool:
    """True where the device is untouched; two shifts at a time in a group would meet."""
    group = int(draft.placement.group_of[device])
    return draft.room.free(("device", device), begin, end) and draft.room.free(
        ("shift", group), begin, end
    )


def _stretch(time: int, length: int) -> tuple[int, int]:
    """What a pause touches: where it goes to earlier, the silence that it shortens."""
    return (time + min(0, length), time)


def _alone(
    draft: Draft, both: TwoTimes, to_change: Integers, long: bool, random: np.random.Generator
) -> tuple[int, int, Integers]:
    """Moves the device alone: how many passes, until when, and the times it had before."""
    chains = draft.chains
    device = chains.device_at(int(both.positions[0]))
    before = draft.time[chains.start[device] : chains.start[device + 1]].copy()
    changed, last = 0, 0
    for position in np.sort(both.positions[to_change]).tolist():
        start = int(draft.time[position - 1])
        moves = draft.carried(position, start + int(random.choice(both.of(long))))
        if moves is None:
            continue
        for each, time in moves:
            draft.time[each] = time
        changed += 1
        last = max(last, moves[-1][1], int(chains.time[moves[-1][0]]))
    return changed, last, before


def _waits(
    draft: Draft,
    both: TwoTimes,
    to_change: Integers,
    wanted: int,
    *,
    long: bool,
    random: np.random.Generator,
) -> list[tuple[int, int]]:
    """Times from which the group is to be moved, and by how much."""
    made: list[tuple[int, int]] = []
    for index in to_change.tolist():
        if len(made) == wanted:
            break
        position = int(both.positions[index])
        time = int(draft.chains.time[position])
        least, most = _leeway(draft, position)
        lengths = both.of(long) - both.times[index]
        lengths = lengths[(lengths >= least) & (lengths <= most)]
        if not len(lengths):
            continue
        length = int(random.choice(lengths))
        group = draft.group_at(position)
        stretch = _stretch(time, length)
        if draft.room.free(("group", group), *stretch) and draft.pause_fits(group, time, length):
            made.append((time, length))
    return made


def _leeway(draft: Draft, position: int) -> tuple[int, int]:
    """By how much a group can be moved at an event so that no other device departs."""
    chains = draft.chains
    time, own = int(chains.time[position]), chains.device_at(position)
    least, most = -(2**62), 2**62
    for device in np.flatnonzero(draft.placement.group_of == draft.group_at(position)).tolist():
        if device == own:
            continue
        first, end = int(chains.start[device]), int(chains.start[device + 1])
        after = first + int(np.searchsorted(chains.time[first:end], time))
        if after == end or not draft.linked(after):
            continue
        transition = int(chains.transition[after])
        takes = int(chains.time[after] - chains.time[after - 1])
        least = max(least, int(chains.minimum[transition]) - takes)
        most = min(most, int(chains.maximum[transition]) - takes)
        # Moved to earlier, nothing passes the event that came before.
        least = max(least, int(chains.time[after - 1]) - time + draft.tick_ns)
    return least, most
