"""Event logs: the runs of a machine, each a sequence of activities."""

from __future__ import annotations

import os
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

from runglight import _engine
from runglight.errors import InputError
from runglight.log.changelog import Log, as_log
from runglight.log.symbols import read_symbols

if TYPE_CHECKING:
    from collections.abc import Sequence
    from os import PathLike


class EventLog:
    """The runs of a machine.

    An activity is a set of changes of one class at one time, like `%IX0.1=0 & %IX0.2=1`; its class
    is `input`, `output`, or None where the log does not tell.
    """

    def __init__(self, engine_log: _engine.EventLog) -> None:
        self._engine = engine_log

    @classmethod
    def from_traces(cls, traces: Sequence[Sequence[str]]) -> EventLog:
        """From names of activities; the events of a trace are one second apart."""
        return cls(_engine.EventLog.from_traces(traces))

    def __len__(self) -> int:
        return len(self._engine)

    def __repr__(self) -> str:
        return f"<runglight.EventLog of {self.traces:,} traces, {len(self):,} events>"

    @property
    def engine(self) -> _engine.EventLog:
        """The compiled engine's event log."""
        return self._engine

    @property
    def traces(self) -> int:
        """Number of traces."""
        return self._engine.traces

    @property
    def activities(self) -> list[tuple[str, str | None]]:
        """Name and class of each activity, in the order of their numbers."""
        return self._engine.activities

    @property
    def names(self) -> list[str]:
        """Name of each trace."""
        return self._engine.names

    def columns(self) -> tuple[Any, Any, Any]:
        """`(activity, time_ns, bounds)` as numpy arrays: trace `n` is `bounds[n]:bounds[n + 1]`."""
        return self._engine.columns()

    def select(self, traces: Sequence[int]) -> EventLog:
        """Some of the traces, by number from 0; activities keep their numbers."""
        return EventLog(self._engine.select(traces))

    def write(self, path: str | PathLike[str]) -> None:
        """Writes XES; the file appears whole or not at all."""
        self._engine.write_xes(os.fspath(path))

    def sequences(self) -> list[list[str]]:
        """The names of the activities, trace by trace."""
        names = [name for name, _ in self.activities]
        activity, _, bounds = self.columns()
        return [
            [names[number] for number in activity[start:end]] for start, end in pairwise(bounds)
        ]


def read_event_log(path: str | PathLike[str]) -> EventLog:
    """Reads XES of any tool, trace by trace; events that have a life cycle count once."""
    return EventLog(_engine.EventLog.read_xes(os.fspath(path)))


def event_log(
    log: Log | Any,
    *,
    reset: str,
    symbols: str | PathLike[str] | None = None,
    naming: str | None = None,
    keep_partial: bool = False,
    only: Sequence[str] = (),
) -> EventLog:
    """Cuts an I/O log into runs (Theis 2019, Algorithm 1).

    Parameters
    ----------
    log
        A `Log`, or an Arrow table `time`, `signal`, `value`.
    reset
        The change that opens a run: `"%IX0.1=0"`, several at one time joined by `&`.
    symbols
        Symbol table (`symbols.csv`), for classes that the names do not tell.
    naming
        How names split into group, device and signal.
    keep_partial
        Keep what lies before the first reset and after the last one, and runs that a gap cuts.
    only
        Signals that take part; none: all of them.

    """
    if not reset:
        raise InputError("event_log: reset is empty; name the change that opens a run: %IX0.1=0")
    text = None if symbols is None else read_symbols(Path(symbols))
    rows = as_log(log)
    return EventLog(_engine.event_log(rows.engine, reset, text, naming, keep_partial, list(only)))
