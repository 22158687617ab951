"""Events and changes matched one by one, by hand."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from runglight.identification.agreement import agreement, slack_ns

S = 1_000_000_000


def of(
    events_s: list[float], changes_s: list[float], tau_s: float = 10.0, slack_s: float = 2.0
) -> float:
    events, changes = (np.array(times, np.float64) * S for times in (events_s, changes_s))
    return agreement(
        events.astype(np.int64), changes.astype(np.int64), int(tau_s * S), int(slack_s * S)
    )


@pytest.mark.parametrize(
    ("events_s", "changes_s", "expected"),
    [
        ([10, 20, 30], [9, 19, 29], 1.0),
        # However late, if always alike.
        ([10, 20, 30], [3, 13, 23], 1.0),
        # Out of the window.
        ([10], [21], 0.0),
        ([], [1, 2], 0.0),
        # One event was missed: three pairs of seven.
        ([10, 20, 30], [9, 19, 29, 39], 6 / 7),
        # A slot is two changes for one event.
        ([10, 20], [9, 9.5, 19, 19.5], 4 / 6),
        # Four changes for four events, but each at another lag: only two fit together.
        ([10, 13, 16, 19], [4, 12, 18, 26], 4 / 8),
        # Neighbours within reach of one another do not count twice.
        ([1.5, 4.5, 7.5], [3, 5.0, 8], 1.0),
        ([0, 3, 6, 9], [1, 4, 7, 10], 1.0),
        # A clock in a window is no better than chance.
        ([10, 13, 16, 19], [8, 16, 24, 32], 4 / 8),
    ],
)
def test_pairs_at_one_lag(events_s: list[float], changes_s: list[float], expected: float) -> None:
    assert of(events_s, changes_s) == pytest.approx(expected)


def test_slack_is_two_scans_or_an_eighth_of_tau() -> None:
    assert slack_ns(10 * S, S) == 2 * S
    assert slack_ns(10 * S, S // 100) == 10 * S // 8


times = st.lists(st.integers(0, 40), max_size=5, unique=True).map(sorted)


@settings(deadline=None, max_examples=60)
@given(times, times, st.integers(0, 12), st.integers(0, 5))
def test_it_is_the_best_of_all_matchings(
    events: list[int], changes: list[int], tau: int, slack: int
) -> None:
    found = agreement(np.array(events, np.int64), np.array(changes, np.int64), tau, slack)
    best = max(
        (
            most_pairs(events, changes, least, min(least + slack, tau))
            for least in range(-tau, tau + 1)
        ),
        default=0,
    )
    assert found == pytest.approx(2 * best / max(len(events) + len(changes), 1))


def most_pairs(events: list[int], changes: list[int], least: int, largest: int) -> int:
    """By trying everything."""
    if not events:
        return 0
    first, rest = events[0], events[1:]
    most = most_pairs(rest, changes, least, largest)
    for at, change in enumerate(changes):
        if least <= first - change <= largest:
            left = changes[:at] + changes[at + 1 :]
            most = max(most, 1 + most_pairs(rest, left, least, largest))
    return most
