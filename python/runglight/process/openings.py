"""Which changes a run may begin with: what every candidate would cut a log into.

A machine repeats itself. Where a log is cut at the right change, nearly all runs do the same; that
is what candidates are ranked by. The order inside a run may differ (stations work side by side),
so what counts first is which activities a run has.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import msgspec
import numpy as np

from runglight.errors import InputError
from runglight.process.event_log import EventLog, event_log

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    import numpy.typing as npt

    from runglight.log.changelog import Log

JUDGED_EVENTS = 200_000
"""The first so many are enough to tell."""
FEWEST_RUNS = 3
_ODD = 0x9E3779B97F4A7C15
_SEED = 20161


class Opening(msgspec.Struct, frozen=True):
    """One change, and what the log is when cut at the activities that contain it."""

    change: str
    """`%IX0.1=0`."""
    signal_class: str | None
    times: int
    """How often it was seen."""
    runs: int
    """Whole runs."""
    same_activities: float
    """Share of the runs that have the commonest set of activities, each as often."""
    same_order: float
    """Share of the runs that are the commonest one, in the same order."""
    events: int
    """Events of the commonest run."""
    seconds: float
    """Median length of a run."""
    pause_s: float
    """How long it was quiet before, at the median."""


def openings(
    log: Log,
    *,
    symbols: Path | None = None,
    naming: str | None = None,
    only: Sequence[str] = (),
) -> tuple[list[Opening], EventLog]:
    """Every change that was seen often enough, the likeliest opening of a run first.

    Also gives all the activities in their order. InputError where nothing changes. Arguments as
    those of `event_log`.
    """
    events = uncut(log, symbols=symbols, naming=naming, only=only)
    activity, time_ns, _ = events.columns()
    judged = _Judged(
        np.asarray(activity[:JUDGED_EVENTS], np.int64),
        np.asarray(time_ns[:JUDGED_EVENTS], np.int64),
        len(events.activities),
    )
    found = []
    for (change, kind), numbers in _by_change(events.activities).items():
        cuts = judged.cuts(numbers)
        if len(cuts) > FEWEST_RUNS:
            found.append(judged.opening(change, kind, cuts))
    return sorted(found, key=_rank), events


def changes_of(activity: str) -> list[str]:
    """The changes of an activity's name: `%IX0.1=0 & %IX0.2=1`."""
    return activity.split(" & ")


def uncut(
    log: Log,
    *,
    symbols: Path | None = None,
    naming: str | None = None,
    only: Sequence[str] = (),
) -> EventLog:
    """All activities of a log in their order, wherever its runs begin."""
    # Where it is cut does not change what an activity is; the first change is as good as any.
    _, index, value = log.engine.columns()
    wanted = {name: number for number, name in enumerate(log.signals)}
    numbers = [wanted[name] for name in only if name in wanted] or list(range(len(log.signals)))
    for row in _changes(np.asarray(index), np.asarray(value), numbers):
        reset = f"{log.signals[int(index[row])]}={int(value[row])}"
        try:
            return event_log(
                log, reset=reset, symbols=symbols, naming=naming, keep_partial=True, only=only
            )
        except InputError:
            # The log's beginning shows how things stand; what seems to change there does not.
            continue
    raise InputError("nothing changes in this log; choose a recording of the machine at work")


def _changes(
    index: npt.NDArray[np.integer], value: npt.NDArray[np.integer], numbers: list[int]
) -> list[int]:
    """A few rows that change a signal."""
    rows: list[int] = []
    for number in numbers:
        of_signal = np.flatnonzero(index == number)
        changed = of_signal[1:][np.diff(value[of_signal]) != 0]
        rows += changed[-1:].tolist()
        if len(rows) >= 8:
            break
    return rows


def _by_change(
    activities: Sequence[tuple[str, str | None]],
) -> dict[tuple[str, str | None], list[int]]:
    found: dict[tuple[str, str | None], list[int]] = {}
    for number, (name, kind) in enumerate(activities):
        for change in changes_of(name):
            found.setdefault((change, kind), []).append(number)
    return found


class _Judged:
    """The activities of a log, in their order."""

    def __init__(
        self, activity: npt.NDArray[np.int64], time_ns: npt.NDArray[np.int64], kinds: int
    ) -> None:
        self._time_ns = time_ns
        self._of_kind: list[npt.NDArray[np.intp]] = []
        order = np.argsort(activity, kind="stable")
        bounds = np.searchsorted(activity[order], np.arange(kinds + 1))
        self._of_kind = [order[bounds[n] : bounds[n + 1]] for n in range(kinds)]
        marks = np.random.default_rng(_SEED).integers(1, 2**63, kinds, np.uint64)[activity]
        # A sum that knows the order: every event weighs by its place in the log, and the place of
        # the run's beginning is divided out again (powers of an odd number modulo 2^64).
        self._sums = _running(marks)
        self._ordered = _running(marks * _powers(_ODD, len(activity)))
        self._inverse = _powers(pow(_ODD, -1, 2**64), len(activity))

    def cuts(self, numbers: list[int]) -> npt.NDArray[np.intp]:
        """Where any of some activities happen."""
        return np.sort(np.concatenate([self._of_kind[number] for number in numbers]))

    def opening(self, change: str, kind: str | None, cuts: npt.NDArray[np.intp]) -> Opening:
        starts, ends = cuts[:-1], cuts[1:]
        same_activities, typical = _commonest(self._sums[ends] - self._sums[starts])
        ordered = (self._ordered[ends] - self._ordered[starts]) * self._inverse[starts]
        same_order, _ = _commonest(ordered)
        return Opening(
            change=change,
            signal_class=kind,
            times=len(cuts),
            runs=len(starts),
            same_activities=same_activities,
            same_order=same_order,
            events=int(ends[typical] - starts[typical]),
            seconds=float(np.median(self._time_ns[ends] - self._time_ns[starts])) / 1e9,
            pause_s=float(np.median(self._time_ns[ends] - self._time_ns[ends - 1])) / 1e9,
        )


def _running(values: npt.NDArray[np.uint64]) -> npt.NDArray[np.uint64]:
    return np.concatenate([np.zeros(1, np.uint64), np.cumsum(values, dtype=np.uint64)])


def _powers(base: int, count: int) -> npt.NDArray[np.uint64]:
    powers = np.full(count, base, np.uint64)
    powers[:1] = 1
    return np.cumprod(powers, dtype=np.uint64)


def _commonest(sums: npt.NDArray[np.uint64]) -> tuple[float, int]:
    """Share of the commonest value, and where it stands first."""
    _, first, counts = np.unique(sums, return_index=True, return_counts=True)
    best = int(np.argmax(counts))
    return float(counts[best]) / len(sums), int(first[best])


def _rank(opening: Opening) -> tuple[float, bool, float, float, str]:
    """Runs that are alike; of equal ones a sensor's change, longer runs, a longer pause before."""

    def repeated(share: float) -> float:
        # One run is always like itself.
        return round((share * opening.runs - 1) / (opening.runs - 1), 2)

    return (
        -repeated(opening.same_activities) - repeated(opening.same_order) / 2,
        opening.signal_class == "output",
        -opening.events,
        -round(opening.pause_s, 1),
        opening.change,
    )
