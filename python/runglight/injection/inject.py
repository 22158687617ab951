"""One call from a clean log and a plan to a faulty log and its labels."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from runglight.errors import InputError
from runglight.injection.branch_shift import inject_branch_shifts
from runglight.injection.chains import Rows, chains_of, rows_of
from runglight.injection.draft import Draft, Truth
from runglight.injection.kinds import SEQUENCE_KINDS, InjectionKind
from runglight.injection.labels import InjectionLabel, iso
from runglight.injection.placement import Placement, placement_of
from runglight.injection.room import Room
from runglight.injection.sequence import inject_faults
from runglight.injection.stall import inject_stalls
from runglight.injection.time_shift import inject_time_shifts
from runglight.injection.timing import inject_early, inject_late
from runglight.log.changelog import Log
from runglight.model import NominalModel, learn

if TYPE_CHECKING:
    from collections.abc import Sequence
    from os import PathLike
    from typing import Any

    from runglight.injection.plan import InjectionPlan

# Shifts need the longest undisturbed stretches, so they choose first; single events go anywhere.
_INJECTORS = (
    ("time_shifts", inject_time_shifts),
    ("branch_shifts", inject_branch_shifts),
    ("stalls", inject_stalls),
    ("faults", inject_faults),
    ("late", inject_late),
    ("early", inject_early),
)
_ASKED_FOR = (
    ("faults", "faults of order", SEQUENCE_KINDS),
    ("late", "late transitions", (InjectionKind.LATE,)),
    ("early", "early transitions", (InjectionKind.EARLY,)),
    ("stalls", "stalls", (InjectionKind.STALL,)),
    ("branch_shifts", "shifts of a branch", (InjectionKind.BRANCH_SHIFT,)),
    ("time_shifts", "shifts of times", (InjectionKind.TIME_SHIFT,)),
)


@dataclass(frozen=True, slots=True)
class Injected:
    """The faulty log, the truth about it in time order, and what did not fit."""

    log: Log
    labels: list[InjectionLabel]
    shortfalls: list[str]
    """One sentence for each kind of which the log could not take as many as asked."""


def inject(
    log: Log,
    plan: InjectionPlan,
    *,
    reference: Sequence[Log] = (),
    symbols: str | PathLike[str] | None = None,
    **parameters: Any,
) -> Injected:
    """Puts the faults of a plan into a fault-free log.

    Devices are those of `runglight.learn(log, symbols, **parameters)`. `reference` are further
    fault-free logs of the machine: what happens in them is nominal too.
    """
    return inject_with(log, plan, learn([log, *reference], symbols, **parameters), reference)


def inject_with(
    log: Log, plan: InjectionPlan, model: NominalModel, reference: Sequence[Log] = ()
) -> Injected:
    """As `inject`, with a model that has been learned from exactly `[log, *reference]`."""
    symbols = list(dict.fromkeys(name for each in (log, *reference) for name in each.signals))
    placement = placement_of(symbols, model.symbols())
    rows = rows_of(log, placement)
    references = [rows_of(each, placement) for each in reference]
    for each in (rows, *references):
        words = each.signal[(each.value & ~1) != 0]
        placement.word[np.unique(words)] = True
    draft = Draft(
        rows=rows,
        chains=chains_of(rows, references, placement),
        placement=placement,
        room=Room(round(plan.spacing_s * 1e9)),
        tick_ns=_resolution(rows),
        window_ns=_scan_window(log, reference),
        clean_until_ns=_clean_until(rows, plan),
    )
    # Each kind draws from its own generator: more of one leaves the others as they were.
    seeds = np.random.SeedSequence(plan.seed).spawn(len(_INJECTORS))
    for (field, injector), seed in zip(_INJECTORS, seeds, strict=True):
        if getattr(plan, field):
            injector(draft, plan, np.random.default_rng(seed))
    _leave_out_what_is_cut(draft)
    changed = Log.from_columns(
        *draft.columns(), [*placement.symbols], scan_interval_s=log.scan_interval_s
    )
    return Injected(changed, _labels(draft), _shortfalls(draft, plan))


def _resolution(rows: Rows) -> int:
    """The largest step that all times of the log are whole multiples of."""
    return max(1, int(np.gcd.reduce(np.diff(rows.time)))) if len(rows.time) > 1 else 1


def _scan_window(log: Log, reference: Sequence[Log]) -> int:
    known = [each.engine.scan_interval_ns for each in (log, *reference)]
    return max((interval for interval in known if interval is not None), default=0)


def _clean_until(rows: Rows, plan: InjectionPlan) -> int:
    if not len(rows.time):
        raise InputError("the log is empty: there is nothing to put faults into")
    first, last = int(rows.time[0]), int(rows.time[-1])
    if plan.from_ns is None:
        return first + round(plan.after * (last - first))
    if plan.from_ns > last:
        raise InputError(f"from: the log ends at {iso(last)}, before {iso(plan.from_ns)}")
    return plan.from_ns


def _leave_out_what_is_cut(draft: Draft) -> None:
    """A stall chosen later may have pushed what was chosen before past the end."""
    cut_ns = draft.cut_ns()
    draft.truths = [truth for truth in draft.truths if _placed(draft, truth)[2] <= cut_ns]


def _shortfalls(draft: Draft, plan: InjectionPlan) -> list[str]:
    sentences = []
    for field, noun, kinds in _ASKED_FOR:
        wanted: int = getattr(plan, field)
        done = sum(truth.kind in kinds for truth in draft.truths)
        if done < wanted:
            sentences.append(
                f"the log has room for {done:,} of the {wanted:,} {noun} asked for; "
                "less spacing, fewer of the others or a longer log make room"
            )
    return sentences


def _labels(draft: Draft) -> list[InjectionLabel]:
    placed = [(_placed(draft, truth), truth) for truth in draft.truths]
    placed.sort(key=lambda pair: (pair[0], pair[1].kind))
    return [
        _label(draft.placement, draft, f"F{number:05}", times, truth)
        for number, (times, truth) in enumerate(placed, 1)
    ]


def _placed(draft: Draft, truth: Truth) -> tuple[int, int, int]:
    """Time, start and end in the faulty log, where pauses have moved the group."""
    start = draft.moved(truth.group, truth.start)
    return start + truth.time - truth.start, start, draft.moved(truth.group, truth.end)


def _label(
    placement: Placement, draft: Draft, name: str, times: tuple[int, int, int], truth: Truth
) -> InjectionLabel:
    def state(of: int | None) -> str | None:
        return None if of is None else placement.state_name(*draft.chains.signal_value(of))

    time, start, end = times
    return InjectionLabel(
        id=name,
        time=iso(time),
        start=iso(start),
        end=iso(end),
        kind=truth.kind,
        group=placement.groups[truth.group],
        device=None if truth.device is None else placement.devices[truth.device],
        signal=None if truth.signal is None else placement.names[truth.signal],
        from_state=state(truth.current),
        to_state=state(truth.next),
        size_s=truth.size_s,
        share=None if truth.share is None else round(truth.share, 6),
        description=truth.description,
    )
