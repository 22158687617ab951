"""Shifted branch probabilities: over a period, a device takes a branch in another share.

A *round* leads from the branching state back to it. Rounds that begin one way are replaced by
copies of rounds that begin the other way; as every signal ends a round as it began it, no order
arises that the clean log does not have.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from runglight.injection.chains import Integers
from runglight.injection.draft import Draft, Truth
from runglight.injection.kinds import InjectionKind
from runglight.injection.plan import InjectionPlan
from runglight.injection.time_shift import (
    ACCEPTED,
    LEAST_PASSES,
    LEAST_SHARE,
    room_for_shift,
)

ROUND_AT_MOST = 500
"""Events in a round that is copied."""


@dataclass(frozen=True, slots=True)
class Rounds:
    """All rounds of a device from one state that end with every signal as at their start."""

    first: Integers
    """Position of the branching state."""
    last: Integers
    """Position at which it comes again."""
    next: Integers
    """The state the round begins with."""


def inject_branch_shifts(draft: Draft, plan: InjectionPlan, random: np.random.Generator) -> int:
    """Shifts `plan.branch_shifts` branches; returns how many were possible."""
    done = 0
    for state in random.permutation(_branching_states(draft)).tolist():
        if done == plan.branch_shifts:
            break
        truth = _shift(draft, state, plan, random)
        if truth is not None:
            draft.truths.append(truth)
            done += 1
    return done


def _branching_states(draft: Draft) -> Integers:
    """States that are left in two ways or more, each often enough."""
    chains = draft.chains
    current = chains.codes // chains.states
    states, inverse = np.unique(current, return_inverse=True)
    total = np.bincount(inverse, weights=chains.count)
    often = (chains.count >= LEAST_SHARE * total[inverse]) & (total[inverse] >= LEAST_PASSES)
    ways = np.bincount(inverse, weights=often)
    return states[ways >= 2]


def _shift(
    draft: Draft, state: int, plan: InjectionPlan, random: np.random.Generator
) -> Truth | None:
    chains = draft.chains
    device = int(draft.placement.device_of[chains.signal_value(state)[0]])
    group = int(draft.placement.group_of[device])
    rounds = _rounds(draft, device, state)
    later = np.flatnonzero(chains.time[rounds.first] >= draft.clean_until_ns)
    chosen = _rarest_way(rounds)
    if chosen is None or len(later) < LEAST_PASSES:
        return None
    way, clean_share = chosen
    passes = min(plan.shift_passes, len(later))
    offset = int(random.integers(0, len(later) - passes + 1))
    period = later[offset : offset + passes]
    already = int((rounds.next[period] == way).sum())
    wanted = max(0, round((clean_share + plan.shift_by) * passes) - already)
    least = max(1, (clean_share + ACCEPTED * plan.shift_by) * passes - already)
    others = random.permutation(period[rounds.next[period] != way])[:wanted]
    begin = int(chains.time[rounds.first[period[0]]])
    end = int(chains.time[rounds.last[period[-1]]])
    if len(others) < least or not room_for_shift(draft, device, begin, end):
        return None
    stretch = slice(int(chains.start[device]), int(chains.start[device + 1]))
    before = draft.time[stretch].copy()
    templates = np.flatnonzero(rounds.next == way)
    replaced, last = _replace(draft, rounds, others, templates, random)
    if len(replaced) < least or not room_for_shift(draft, device, begin, last):
        draft.time[stretch] = before
        return None
    for each, template in replaced:
        _write(draft, rounds, each, template)
    end = max(end, last)
    draft.room.take(("device", device), begin, end)
    draft.room.take(("shift", group), begin, end)
    reached = (already + len(replaced)) / passes
    here = draft.placement.state_name(*chains.signal_value(state))
    there = draft.placement.state_name(*chains.signal_value(way))
    return Truth(
        kind=InjectionKind.BRANCH_SHIFT,
        group=group,
        device=device,
        signal=chains.signal_value(way)[0],
        time=begin,
        start=begin,
        end=end,
        current=state,
        next=way,
        share=reached - clean_share,
        description=(
            f"over {passes} passes of {here}, {reached:.0%} go on to {there} "
            f"instead of {clean_share:.0%}"
        ),
    )


def _rarest_way(rounds: Rounds) -> tuple[int, float] | None:
    """The way that is to be taken more often, and its share: the rarest that is no exception."""
    ways, count = np.unique(rounds.next, return_counts=True)
    share = count / max(1, len(rounds.next))
    candidates = np.flatnonzero((share >= LEAST_SHARE) & (share <= 1 - LEAST_SHARE))
    if not len(candidates):
        return None
    rarest = int(candidates[share[candidates].argmin()])
    return int(ways[rarest]), float(share[rarest])


def _rounds(draft: Draft, device: int, state: int) -> Rounds:
    chains = draft.chains
    start, end = int(chains.start[device]), int(chains.start[device + 1])
    values = len(chains.values)
    visits = start + np.flatnonzero(chains.state[start:end] == state)
    unlinked = np.cumsum(chains.transition[start:end] < 0)
    present: dict[int, int] = {}
    image: dict[int, frozenset[tuple[int, int]]] = {}
    visited = set(visits.tolist())
    for position, each in enumerate(chains.state[start:end].tolist(), start):
        present[each // values] = each
        if position in visited:
            image[position] = frozenset(present.items())
    usual = _most_common(image)
    kept = [
        (first, last)
        for first, last in zip(visits[:-1].tolist(), visits[1:].tolist(), strict=True)
        if last - first <= ROUND_AT_MOST
        and image[first] == usual == image[last]
        and unlinked[last - start] == unlinked[first - start]
    ]
    pairs = np.array(kept, dtype=np.int64).reshape(-1, 2)
    return Rounds(pairs[:, 0], pairs[:, 1], chains.state[pairs[:, 0] + 1])


def _most_common(image: dict[int, frozenset[tuple[int, int]]]) -> frozenset[tuple[int, int]] | None:
    counts: dict[frozenset[tuple[int, int]], int] = {}
    for each in image.values():
        counts[each] = counts.get(each, 0) + 1
    return max(counts, key=lambda each: counts[each], default=None)


def _replace(
    draft: Draft, rounds: Rounds, others: Integers, templates: Integers, random: np.random.Generator
) -> tuple[list[tuple[int, int]], int]:
    """Which rounds can take which template's length, and until when that moves the device."""
    chains = draft.chains
    replaced: list[tuple[int, int]] = []
    until = 0
    for each in np.sort(others).tolist():
        template = int(random.choice(templates))
        last = int(rounds.last[each])
        length = int(chains.time[rounds.last[template]] - chains.time[rounds.first[template]])
        moves = draft.carried(last, int(draft.time[rounds.first[each]]) + length)
        if moves is None:
            continue
        for position, time in moves:
            draft.time[position] = time
        replaced.append((each, template))
        until = max(until, moves[-1][1], int(chains.time[moves[-1][0]]))
    return replaced, until


def _write(draft: Draft, rounds: Rounds, each: int, template: int) -> None:
    """Puts the template's events in the place of a round's; the last event of both is the same."""
    chains = draft.chains
    first, last = int(rounds.first[each]), int(rounds.last[each])
    origin = int(rounds.first[template])
    for position in range(first + 1, last):
        draft.drop(position)
    for position in range(origin + 1, int(rounds.last[template])):
        time = int(draft.time[first] + chains.time[position] - chains.time[origin])
        draft.insert(time, int(chains.state[position]), first)
