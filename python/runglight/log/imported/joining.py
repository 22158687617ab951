"""Several logs as one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from runglight.log.changelog import Log

if TYPE_CHECKING:
    from collections.abc import Sequence


def joined(logs: Sequence[Log]) -> Log:
    """The rows of all logs in time order; those of one time in the order of the logs."""
    index_of: dict[str, int] = {}
    columns = []
    for log in logs:
        time_ns, signal, value = log.columns()
        indices = [index_of.setdefault(name, len(index_of)) for name in log.signals]
        columns.append((time_ns, np.array(indices, np.uint32)[signal], value))
    if not columns:
        return Log.from_columns(
            np.empty(0, np.int64), np.empty(0, np.uint32), np.empty(0, np.int64), []
        )
    time_ns, signal, value = (np.concatenate(each) for each in zip(*columns, strict=True))
    if (np.diff(time_ns) < 0).any():
        order = np.argsort(time_ns, kind="stable")
        time_ns, signal, value = time_ns[order], signal[order], value[order]
    return Log.from_columns(time_ns, signal, value, list(index_of))
