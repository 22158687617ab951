"""What every monitor does, whatever it watches with: the verbs, stated once."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

from runglight.findings.batch import Findings
from runglight.log.changelog import Log, arrow_table
from runglight.moments import nanoseconds

if TYPE_CHECKING:
    from datetime import datetime

    from runglight import _engine


class EngineMonitor(Protocol):
    """A monitor of the compiled engine."""

    def observe(self, batch: Any) -> _engine.Findings:
        """Takes changes."""

    def advance(self, now_ns: int) -> _engine.Findings:
        """Takes a time."""

    def gap(self, start_ns: int, end_ns: int) -> _engine.Findings:
        """Takes a gap."""

    def finish(self) -> _engine.Findings:
        """Takes the end."""

    def state(self) -> bytes:
        """What it knows."""


Engine = TypeVar("Engine", bound=EngineMonitor)


class MonitorVerbs(Generic[Engine]):
    """Watches one machine. Every split of a log into batches gives the same findings."""

    def __init__(self, engine_monitor: Engine) -> None:
        self._engine = engine_monitor

    def observe(self, batch: Log | Any) -> Findings:
        """Takes changes in time order: a `Log`, or an Arrow table `time`, `signal`, `value`."""
        rows = batch.engine if isinstance(batch, Log) else arrow_table(batch)
        return Findings(self._engine.observe(rows))

    def advance(self, now: datetime | int) -> Findings:
        """Time went on without a change (aware datetime, or nanoseconds since 1970).

        What was due by then and has not come is told.
        """
        return Findings(self._engine.advance(nanoseconds(now)))

    def gap(self, start: datetime | int, end: datetime | int) -> Findings:
        """Nothing was recorded between two times: resynchronises instead of alarming."""
        return Findings(self._engine.gap(nanoseconds(start), nanoseconds(end)))

    def finish(self) -> Findings:
        """The log has ended."""
        return Findings(self._engine.finish())

    def state(self) -> bytes:
        """Everything the monitor knows, for `monitor(state=…)` of what it was made of."""
        return self._engine.state()
