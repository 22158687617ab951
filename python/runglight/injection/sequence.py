"""Faults of order: edges that stay away, edges too many, edges that change places."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from runglight.injection.departure import Departure, Step
from runglight.injection.draft import Draft, Truth
from runglight.injection.kinds import InjectionKind
from runglight.injection.plan import InjectionPlan

if TYPE_CHECKING:
    from runglight.injection.chains import Integers

ATTEMPTS_PER_FAULT = 200
ATTEMPTS_AT_LEAST = 20_000
LOOK_BACK_AT_MOST = 2_000
"""Events of a device that are searched for a signal's present value or next edge."""
PULSE_AT_MOST_S = 0.5

Attempt = Callable[[Draft, int, InjectionPlan, np.random.Generator], Truth | None]


def inject_faults(draft: Draft, plan: InjectionPlan, random: np.random.Generator) -> int:
    """Puts `plan.faults` faults in, in equal parts of each kind; returns how many found a place.

    What one kind cannot place, the others do.
    """
    places = {kind: iter(_places(draft, kind, random).tolist()) for kind in plan.kinds}
    attempts = max(ATTEMPTS_AT_LEAST, ATTEMPTS_PER_FAULT * plan.faults)
    left = dict.fromkeys(plan.kinds, attempts)
    done = 0
    while done < plan.faults and left:
        for kind in list(left):
            if done == plan.faults:
                break
            for position in places[kind]:
                left[kind] -= 1
                truth = _ATTEMPTS[kind](draft, position, plan, random)
                if truth is not None:
                    draft.truths.append(truth)
                    done += 1
                    break
                if left[kind] <= 0:
                    del left[kind]
                    break
            else:
                del left[kind]
    return done


def _places(draft: Draft, kind: InjectionKind, random: np.random.Generator) -> Integers:
    """Events that a fault of a kind may begin with, in random order."""
    chains = draft.chains
    possible = draft.open()
    signal = chains.state // len(chains.values)
    if kind in (InjectionKind.STUCK_ON, InjectionKind.STUCK_OFF):
        # A signal is stuck on from the edge to OFF that does not come.
        lost = int(kind is InjectionKind.STUCK_OFF)
        possible &= chains.values[chains.state % len(chains.values)] == lost
        possible &= ~draft.placement.word[signal]
    elif kind in (InjectionKind.SPURIOUS_PULSE, InjectionKind.SWAPPED_ORDER):
        needed = max(draft.window_ns, draft.tick_ns)
        needed *= 4 if kind is InjectionKind.SPURIOUS_PULSE else 1
        possible[1:] &= np.diff(chains.time) >= needed
    return random.permutation(np.flatnonzero(possible))


def _stuck(
    draft: Draft, position: int, plan: InjectionPlan, random: np.random.Generator
) -> Truth | None:
    if not _room_at(draft, position):
        return None
    least, most = plan.stuck_cycles
    cycles = int(random.integers(least, most + 1))
    until: int | None = None
    if plan.stuck_for is not None:
        until = int(draft.chains.time[position]) + draft.on_clock(
            float(plan.stuck_for.draw_s(random, 1)[0])
        )
    lost = _edges(draft, position, cycles, until)
    if lost is None:
        return None
    on = draft.chains.signal_value(int(draft.chains.state[position]))[1] == 0
    kind = InjectionKind.STUCK_ON if on else InjectionKind.STUCK_OFF
    stays = "ON" if on else "OFF"
    return _without(draft, kind, lost, f"stays {stays} for {len(lost)} edges")


def _missing(
    draft: Draft, position: int, _plan: InjectionPlan, random: np.random.Generator
) -> Truth | None:
    if not _room_at(draft, position):
        return None
    lost = _edges(draft, position, 1, None)
    if lost is None:
        return None
    # The second edge may still be in the log: it then repeats a value, which is no event.
    repeats = bool(random.integers(2)) and len(lost) == 2
    text = "loses one edge, the next repeats its value" if repeats else f"loses {len(lost)} edges"
    return _without(draft, InjectionKind.MISSING_EDGE, lost, text, keep_last=repeats)


def _without(
    draft: Draft,
    kind: InjectionKind,
    lost: list[int],
    text: str,
    *,
    keep_last: bool = False,
) -> Truth | None:
    first, last = lost[0], lost[-1]
    gone = set(lost)
    steps = [draft.step(each) for each in range(first, last + 1) if each not in gone]
    found = draft.departure(first, last, steps)
    if found is None:
        return None
    departure, context = found
    start = int(draft.chains.time[first])
    shown = max(int(draft.chains.time[last]), departure.time)
    device = draft.chains.device_at(first)
    if not draft.free(device, start, shown, context):
        return None
    draft.take(device, start, shown, context)
    end = max(shown, int(draft.chains.time[last + 1]))
    for each in lost[:-1] if keep_last else lost:
        draft.drop(each)
    return _truth(draft, kind, first, departure, span=(start, end), text=text)


def _pulse(
    draft: Draft, position: int, _plan: InjectionPlan, random: np.random.Generator
) -> Truth | None:
    chains = draft.chains
    device = chains.device_at(position)
    values = _present_values(draft, position)
    if not values or not _room_at(draft, position):
        return None
    before, after = int(chains.time[position - 1]), int(chains.time[position])
    present = int(random.choice(sorted(values.values())))
    signal, value = chains.signal_value(present)
    other = _another_value(draft, device, signal, value, random)
    least = max(draft.window_ns, draft.tick_ns)
    ticks = (after - before - 3 * least) // draft.tick_ns
    most_ticks = max(1, min(ticks // 2, round(PULSE_AT_MOST_S * 1e9) // draft.tick_ns))
    width = least + int(random.integers(0, most_ticks)) * draft.tick_ns
    spare = (after - before - 2 * least - width) // draft.tick_ns
    if other is None or spare < 0:
        return None
    start = before + least + int(random.integers(0, spare + 1)) * draft.tick_ns
    end = start + width
    found = draft.departure(position, position - 1, [Step(start, other), Step(end, present)])
    if found is None:
        return None
    departure, context = found
    shown = max(end, departure.time)
    if not draft.free(device, start, shown, context):
        return None
    draft.take(device, start, shown, context)
    end = max(shown, after)
    draft.insert(start, other, position - 1)
    draft.insert(start + width, present, position - 1)
    blink = f"blinks for {width / 1e9:g} s"
    return _truth(
        draft,
        InjectionKind.SPURIOUS_PULSE,
        position,
        departure,
        span=(start, end),
        text=blink,
        signal=signal,
    )


def _swap(
    draft: Draft, position: int, _plan: InjectionPlan, _random: np.random.Generator
) -> Truth | None:
    if not _room_at(draft, position):
        return None
    first, second = draft.step(position - 1), draft.step(position)
    values = len(draft.chains.values)
    if first.state // values == second.state // values or not draft.linked(position - 1):
        return None
    steps = [Step(first.time, second.state), Step(second.time, first.state)]
    found = draft.departure(position - 1, position, steps)
    if found is None:
        return None
    departure, context = found
    shown = max(second.time, departure.time)
    device = draft.chains.device_at(position)
    if first.time < draft.clean_until_ns or not draft.free(device, first.time, shown, context):
        return None
    draft.take(device, first.time, shown, context)
    end = max(shown, int(draft.chains.time[position + 1]))
    draft.swap(position)
    earlier = draft.placement.state_name(*draft.chains.signal_value(first.state))
    return _truth(
        draft,
        InjectionKind.SWAPPED_ORDER,
        position,
        departure,
        span=(first.time, end),
        text=f"comes before {earlier} instead of after it",
    )


_ATTEMPTS: dict[InjectionKind, Attempt] = {
    InjectionKind.STUCK_ON: _stuck,
    InjectionKind.STUCK_OFF: _stuck,
    InjectionKind.MISSING_EDGE: _missing,
    InjectionKind.SPURIOUS_PULSE: _pulse,
    InjectionKind.SWAPPED_ORDER: _swap,
}


def _room_at(draft: Draft, position: int) -> bool:
    """Quickly turns away what lies where others are."""
    device, time = draft.chains.device_at(position), int(draft.chains.time[position])
    return draft.free(device, time, time, (time, time))


def _edges(draft: Draft, position: int, cycles: int, until: int | None) -> list[int] | None:
    """Events of a signal from `position` on whose absence leaves its value where it began.

    So many whole switching cycles, or those that begin before `until`.
    """
    chains = draft.chains
    values = len(chains.values)
    signal = int(chains.state[position]) // values
    end = min(
        int(chains.start[chains.device_at(position) + 1]), position + cycles * LOOK_BACK_AT_MOST
    )
    lost = [position]
    before = _value_before(draft, position)
    if before is None:
        return None
    for each in range(position + 1, end):
        if not draft.linked(each):
            return None
        if int(chains.state[each]) // values != signal:
            continue
        if draft.placement.word[signal] and int(chains.state[each]) != before:
            # A word goes on to its next value as if nothing had been: one change is lost.
            return lost
        lost.append(each)
        if int(chains.state[each]) != before:
            continue
        whole = len(lost) // 2 >= cycles if until is None else int(chains.time[each]) >= until
        if whole or draft.placement.word[signal]:
            return lost
    return None


def _value_before(draft: Draft, position: int) -> int | None:
    """The state of an event's signal before the event."""
    chains = draft.chains
    values = len(chains.values)
    signal = int(chains.state[position]) // values
    first = max(int(chains.start[chains.device_at(position)]), position - LOOK_BACK_AT_MOST)
    for each in range(position - 1, first - 1, -1):
        state = int(chains.state[each])
        if state // values == signal:
            return state
    if draft.placement.word[signal]:
        return None
    # A boolean that has not been seen yet had the other value.
    return chains.state_of(signal, 1 - chains.signal_value(int(chains.state[position]))[1])


def _present_values(draft: Draft, position: int) -> dict[int, int]:
    """State of every signal of a device before an event, of those that have changed lately."""
    chains = draft.chains
    values = len(chains.values)
    first = max(int(chains.start[chains.device_at(position)]), position - 64)
    present: dict[int, int] = {}
    for each in range(position - 1, first - 1, -1):
        if chains.segment[each] != chains.segment[position]:
            break
        state = int(chains.state[each])
        present.setdefault(state // values, state)
    return present


def _another_value(
    draft: Draft, device: int, signal: int, value: int, random: np.random.Generator
) -> int | None:
    """A state of the signal with another value: the opposite, or one a word has had."""
    chains = draft.chains
    if not draft.placement.word[signal]:
        index = int(np.searchsorted(chains.values, 1 - value))
        found = index < len(chains.values) and chains.values[index] == 1 - value
        return signal * len(chains.values) + index if found else None
    states = np.unique(chains.state[chains.start[device] : chains.start[device + 1]])
    others = states[states // len(chains.values) == signal]
    others = others[others != chains.state_of(signal, value)]
    return int(random.choice(others)) if len(others) else None


def _truth(
    draft: Draft,
    kind: InjectionKind,
    position: int,
    departure: Departure,
    *,
    span: tuple[int, int],
    text: str,
    signal: int | None = None,
) -> Truth:
    time, current, following = departure
    device = draft.chains.device_at(position)
    if signal is None:
        signal = draft.chains.signal_value(int(draft.chains.state[position]))[0]
    return Truth(
        kind=kind,
        group=int(draft.placement.group_of[device]),
        device=device,
        signal=signal,
        time=time,
        start=span[0],
        end=span[1],
        current=current,
        next=following,
        description=f"{draft.placement.names[signal]} {text}",
    )
