"""Stalls: a whole group is silent, and everything it does afterwards comes that much later."""

from __future__ import annotations

import numpy as np

from runglight.injection.chains import Integers
from runglight.injection.draft import Draft, Truth
from runglight.injection.kinds import InjectionKind
from runglight.injection.plan import InjectionPlan

ATTEMPTS_PER_STALL = 500


def inject_stalls(draft: Draft, plan: InjectionPlan, random: np.random.Generator) -> int:
    """Lets groups fall silent `plan.stalls` times; returns how many found a place."""
    groups = len(draft.placement.groups)
    events = [_group_events(draft, group) for group in range(groups)]
    longest = [_longest_silence(draft, each) for each in events]
    sizes = plan.stall_over.draw_s(random, plan.stalls).tolist()
    done = attempts = 0
    while done < plan.stalls and attempts < ATTEMPTS_PER_STALL * plan.stalls:
        attempts += 1
        group = int(random.integers(groups))
        first = int(np.searchsorted(draft.chains.time[events[group]], draft.clean_until_ns))
        if first + 1 >= len(events[group]):
            continue
        at = int(random.integers(first + 1, len(events[group])))
        before, after = (int(each) for each in events[group][at - 1 : at + 1])
        size_ns = draft.on_clock(sizes[done])
        truth = _stall(draft, group, (before, after), longest=longest[group], size_ns=size_ns)
        if truth is not None:
            draft.truths.append(truth)
            done += 1
    return done


def _group_events(draft: Draft, group: int) -> Integers:
    """Positions of a group's events in time order."""
    chains, placement = draft.chains, draft.placement
    positions = np.concatenate(
        [
            np.arange(chains.start[device], chains.start[device + 1])
            for device in np.flatnonzero(placement.group_of == group)
        ]
        or [np.zeros(0, dtype=np.int64)]
    )
    return positions[np.lexsort((chains.row[positions], chains.time[positions]))]


def _longest_silence(draft: Draft, events: Integers) -> int:
    chains = draft.chains
    apart = np.diff(chains.time[events])
    seen = apart[np.diff(chains.segment[events]) == 0]
    return int(seen.max()) if len(seen) else 0


def _stall(
    draft: Draft, group: int, events: tuple[int, int], *, longest: int, size_ns: int
) -> Truth | None:
    chains = draft.chains
    before, after = events
    start, end = int(chains.time[before]), int(chains.time[after])
    length = longest + size_ns - (end - start)
    if (
        start == end
        or chains.segment[before] != chains.segment[after]
        or not draft.room.free(("group", group), start, end)
        or not draft.pause_fits(group, end, length)
    ):
        return None
    draft.room.take(("group", group), start, end)
    draft.pause(group, end, length)
    current, following = int(chains.state[before]), int(chains.state[after])
    signal, value = chains.signal_value(current)
    last = draft.placement.state_name(signal, value)
    return Truth(
        kind=InjectionKind.STALL,
        group=group,
        device=None,
        signal=signal,
        time=start + longest,
        start=start,
        end=end,
        current=current,
        next=following,
        size_s=size_ns / 1e9,
        description=(
            f"{draft.placement.groups[group]} is silent for {(longest + size_ns) / 1e9:g} s "
            f"after {last}; its longest silence was {longest / 1e9:g} s"
        ),
    )
