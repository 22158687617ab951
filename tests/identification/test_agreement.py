"""Events and changes matched one by one, by hand."""

import numpy as np
import pytest

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
        # A clock in a window is no better than chance.
        ([10, 11.5, 20, 29], [8, 16, 24, 32], 4 / 8),
    ],
)
def test_pairs_at_one_lag(events_s: list[float], changes_s: list[float], expected: float) -> None:
    assert of(events_s, changes_s) == pytest.approx(expected)


def test_slack_is_two_scans_or_an_eighth_of_tau() -> None:
    assert slack_ns(10 * S, S) == 2 * S
    assert slack_ns(10 * S, S // 100) == 10 * S // 8
