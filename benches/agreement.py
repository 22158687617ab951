"""How well changes agree with events one by one: what counts in windows cannot tell.

A score of Cadiou 2019 compares numbers: in a window with four events, any four changes are as good
as the four right ones, and a clock that ticks four times in it is perfect. Here each event is
matched with one change, all at nearly the same lag, and what finds no partner counts against it.
"""

import numpy as np
import numpy.typing as npt

Integers = npt.NDArray[np.int64]


def slack_ns(tau_ns: int, scan_ns: int) -> int:
    """By how much lags may differ: somebody's reaction, and a scan before and after."""
    return max(2 * scan_ns, tau_ns // 8)


def agreement(events_ns: Integers, changes_ns: Integers, tau_ns: int, slack: int) -> float:
    """Twice the matched pairs over events and changes: 1 is best, 0 where nothing fits.

    Lags lie within `tau_ns`, and within `slack` of one another: the densest such place of all
    lags is taken. Pairs keep their order, so that a pass over both finds the most there are.
    """
    lags = (events_ns[:, None] - changes_ns[None, :]).ravel()
    lags = np.sort(lags[np.abs(lags) <= tau_ns])
    if not len(lags):
        return 0.0
    reach = np.searchsorted(lags, lags + slack, "right") - np.arange(len(lags))
    least = int(lags[int(np.argmax(reach))])
    event = change = pairs = 0
    while event < len(events_ns) and change < len(changes_ns):
        lag = int(events_ns[event]) - int(changes_ns[change])
        if lag < least:
            event += 1
        elif lag > least + slack:
            change += 1
        else:
            pairs, event, change = pairs + 1, event + 1, change + 1
    return 2 * pairs / (len(events_ns) + len(changes_ns))
