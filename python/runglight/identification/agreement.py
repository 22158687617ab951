"""How well changes agree with events one by one: what counts in windows cannot tell.

A score of Cadiou 2019 compares numbers: in a window with four events, any four changes are as good
as the four right ones, and a clock that ticks four times in it is perfect. Here each event is
matched with one change, all at nearly the same lag, and what finds no partner counts against it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import msgspec
import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt

    from runglight.identification.identify import Candidate

    Integers = npt.NDArray[np.int64]

MOST = 1_000
"""Candidates that are put in order, the best by their scores; the others follow as they were."""

_RESOLUTION = 10_000
"""What differs by less than a ten-thousandth is a tie, as with the scores."""


def slack_ns(tau_ns: int, scan_ns: int) -> int:
    """By how much lags may differ: somebody's reaction, and a scan before and after."""
    return max(2 * scan_ns, tau_ns // 8)


def agreement(events_ns: Integers, changes_ns: Integers, tau_ns: int, slack: int) -> float:
    """Twice the matched pairs over events and changes: 1 is best, 0 where nothing fits.

    Lags of pairs lie within `tau_ns`, and within `slack` of one another, wherever most pairs do.
    """
    lags = (events_ns[:, None] - changes_ns[None, :]).ravel()
    lags = np.sort(lags[np.abs(lags) <= tau_ns])
    if not len(lags):
        return 0.0
    # No more pairs than lags in reach; the same event may be in several of those.
    least = np.unique(lags)
    reach = np.searchsorted(lags, least + slack, "right") - np.searchsorted(lags, least)
    most = np.minimum(reach, min(len(events_ns), len(changes_ns)))
    events, changes = events_ns.tolist(), changes_ns.tolist()
    best = 0
    for place in np.argsort(-most, kind="stable").tolist():
        if most[place] <= best:
            break
        largest = min(int(least[place]) + slack, tau_ns)
        best = max(best, _pairs(events, changes, int(least[place]), largest))
    return 2 * best / (len(events) + len(changes))


def _pairs(events: list[int], changes: list[int], least: int, largest: int) -> int:
    """The most pairs of one event and one change each, with lags from `least` to `largest`.

    The earliest that fit are the best: one pass over both finds the most there are.
    """
    event = change = pairs = 0
    while event < len(events) and change < len(changes):
        lag = events[event] - changes[change]
        if lag < least:
            event += 1
        elif lag > largest:
            change += 1
        else:
            pairs, event, change = pairs + 1, event + 1, change + 1
    return pairs


def by_agreement(
    candidates: list[Candidate],
    moments: list[Integers],
    events_ns: Integers,
    tau_ns: int,
    scan_ns: int,
) -> tuple[list[Candidate], list[int]]:
    """Candidates in a new order, ranked anew, and where each stood before.

    Those of equal agreement have the same rank, and keep the order of their scores.
    """
    slack = slack_ns(tau_ns, scan_ns)
    agreed = [agreement(events_ns, each, tau_ns, slack) for each in moments[:MOST]]
    steps = [round(each * _RESOLUTION) for each in agreed] + [-1] * (len(candidates) - len(agreed))
    places = sorted(range(len(candidates)), key=lambda place: (-steps[place], place))
    ranks: dict[int, int] = {}
    firsts: dict[str, str] = {}
    ordered = [
        msgspec.structs.replace(
            candidates[place],
            rank=ranks.setdefault(steps[place], at + 1),
            same_as=firsts.setdefault(candidates[place].same_as, candidates[place].address),
            agreement=agreed[place] if place < len(agreed) else None,
        )
        for at, place in enumerate(places)
    ]
    return ordered, places
