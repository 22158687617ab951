"""The learned controller beside the real one in a recording."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from runglight import _engine
    from runglight.log.changelog import Log

MOST_ROWS = 300_000
MOST_TOLD = 500
LOOKED_AGAIN_NS = 600_000_000
"""After a change that nothing follows, the shadow looks once more: by then the real controller
should have acted."""


def shadowed(shadow: _engine.Shadow, log: Log) -> list[str]:
    """What a shadow tells of a recording, as JSON lines; of its first rows where it is long."""
    signals = {name: number for number, name in enumerate(log.signals)}
    terminals = {signals.get(address): n for n, (address, _) in enumerate(shadow.terminals)}
    terminals.pop(None, None)
    values: list[int | None] = [None] * len(shadow.terminals)
    time_ns, index, value = (np.asarray(each)[:MOST_ROWS] for each in log.engine.columns())
    gaps = sorted(log.engine.gaps)
    told: list[str] = []
    ends = np.flatnonzero(np.diff(time_ns, append=time_ns[-1:] + 1)) + 1
    first = 0
    for place, end in enumerate(ends.tolist()):
        now_ns = int(time_ns[first])
        while gaps and gaps[0][1] <= now_ns:
            gaps.pop(0)
            shadow.gap()
        for row in range(first, end):
            terminal = terminals.get(int(index[row]))
            if terminal is not None:
                values[terminal] = int(value[row])
        first = end
        if None in values:
            # The shadow takes up the net where all signals are known.
            continue
        told += shadow.scan(now_ns, values).json_lines()
        later_ns = int(time_ns[end]) if place + 1 < len(ends) else now_ns
        if later_ns > now_ns + LOOKED_AGAIN_NS:
            told += shadow.scan(now_ns + LOOKED_AGAIN_NS, values).json_lines()
        if len(told) >= MOST_TOLD:
            break
    return told[:MOST_TOLD]
