"""Faults of time: transitions that take longer, or less, than they ever did."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from runglight.injection.draft import Draft, Truth
from runglight.injection.kinds import InjectionKind
from runglight.injection.plan import InjectionPlan

if TYPE_CHECKING:
    from runglight.injection.chains import Integers


def inject_late(draft: Draft, plan: InjectionPlan, random: np.random.Generator) -> int:
    """Makes `plan.late` transitions late; returns how many found a place."""
    sizes = plan.late_over.draw_s(random, plan.late).tolist()
    done = 0
    for position in _places(draft, plan, random):
        if done == plan.late:
            break
        truth = _late(draft, position, draft.on_clock(sizes[done]))
        if truth is not None:
            draft.truths.append(truth)
            done += 1
    return done


def inject_early(draft: Draft, plan: InjectionPlan, random: np.random.Generator) -> int:
    """Makes `plan.early` transitions early; returns how many found a place."""
    sizes = plan.early_under.draw_s(random, plan.early).tolist()
    done = 0
    for position in _places(draft, plan, random, at_least_s=plan.early_under.least_s):
        if done == plan.early:
            break
        truth = _early(draft, position, draft.on_clock(sizes[done]))
        if truth is not None:
            draft.truths.append(truth)
            done += 1
    return done


def _places(
    draft: Draft, plan: InjectionPlan, random: np.random.Generator, at_least_s: float = 0.0
) -> list[int]:
    """Events whose transition has a true maximum and minimum, in random order."""
    chains = draft.chains
    fit = (chains.count >= plan.minimum_passes) & (chains.maximum <= plan.longest_s * 1e9)
    fit &= chains.minimum >= at_least_s * 1e9
    possible = draft.open()
    possible[possible] = fit[chains.transition[possible]]
    places: Integers = random.permutation(np.flatnonzero(possible))
    found: list[int] = places.tolist()
    return found


def _late(draft: Draft, position: int, size_ns: int) -> Truth | None:
    chains = draft.chains
    before = int(draft.time[position - 1])
    due = before + int(chains.maximum[chains.transition[position]])
    return _moved(
        draft, position, InjectionKind.LATE, time=due, new_time=due + size_ns, size_ns=size_ns
    )


def _early(draft: Draft, position: int, size_ns: int) -> Truth | None:
    chains = draft.chains
    before = int(draft.time[position - 1])
    new_time = before + int(chains.minimum[chains.transition[position]]) - size_ns
    if new_time < before + max(draft.tick_ns, draft.window_ns):
        return None
    return _moved(
        draft, position, InjectionKind.EARLY, time=new_time, new_time=new_time, size_ns=size_ns
    )


def _moved(
    draft: Draft,
    position: int,
    kind: InjectionKind,
    *,
    time: int,
    new_time: int,
    size_ns: int,
) -> Truth | None:
    chains = draft.chains
    device = chains.device_at(position)
    start = int(draft.time[position - 1])
    if not draft.free(device, start, new_time, (start, new_time)):
        return None
    moves = draft.carried(position, new_time)
    if moves is None:
        return None
    last, last_time = moves[-1]
    moved_until = max(last_time, int(draft.time[last]))
    # The transition that absorbs the rest is shorter, or longer, than it would have been.
    end = max(moved_until, int(draft.time[draft.after(last)]))
    if not draft.free(device, start, moved_until, (start, end)):
        return None
    draft.take(device, start, moved_until, (start, end))
    for each, moved in moves:
        draft.time[each] = moved
    current, following = int(chains.state[position - 1]), int(chains.state[position])
    bound, way = ("maximum", "over") if kind is InjectionKind.LATE else ("minimum", "under")
    limit = chains.maximum if kind is InjectionKind.LATE else chains.minimum
    limit_s = int(limit[chains.transition[position]]) / 1e9
    return Truth(
        kind=kind,
        group=int(draft.placement.group_of[device]),
        device=device,
        signal=chains.signal_value(following)[0],
        time=time,
        start=start,
        end=end,
        current=current,
        next=following,
        size_s=size_ns / 1e9,
        description=(
            f"{draft.placement.state_name(*chains.signal_value(following))} comes "
            f"{size_ns / 1e9:g} s {way} its true {bound} of {limit_s:g} s"
        ),
    )
