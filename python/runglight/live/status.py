"""How watching goes: what the status line, the MQTT status and the metrics are made of."""

from __future__ import annotations

import datetime
from collections import Counter, deque
from typing import TYPE_CHECKING

import msgspec

from runglight.findings.finding import decode_finding

if TYPE_CHECKING:
    from collections.abc import Iterable

    from runglight.findings.finding import Finding
    from runglight.taps.base import Batch, Connection

OPEN_STATES = frozenset({"suspected", "confirmed"})
OPEN_AT_MOST = 10_000
RATE_OVER_NS = 5_000_000_000


class Status(msgspec.Struct, frozen=True, kw_only=True):
    """One moment of watching. Published as JSON on `TOPIC/status`."""

    state: str
    """Of the connection to the source: `connecting`, `connected`, `retrying`, `closed`."""
    source: str
    """Where signals come from, without secrets."""
    reason: str | None
    """One sentence while the source is not connected."""
    reconnects: int
    gaps: int
    scans: int
    scans_per_s: float
    changes: int
    last_scan: str | None
    """ISO 8601, UTC."""
    last_change: str | None
    """ISO 8601, UTC."""
    findings: dict[str, int]
    """Findings so far by severity; changes of their state are not counted again."""
    open: int
    """Faults and anomalies that have neither returned nor been acknowledged."""

    def is_like(self, other: Status) -> bool:
        """Whether two differ in nothing but counters that always run."""
        return (self.state, self.reason, self.reconnects, self.gaps, self.findings, self.open) == (
            other.state,
            other.reason,
            other.reconnects,
            other.gaps,
            other.findings,
            other.open,
        )


class Progress:
    """Counts what goes by."""

    def __init__(self, source: str) -> None:
        self._source = source
        self.gaps = 0
        self.scans = 0
        self.changes = 0
        self.last_scan_ns: int | None = None
        self.last_change_ns: int | None = None
        self.severities: Counter[str] = Counter()
        self._known: deque[str] = deque(maxlen=OPEN_AT_MOST)
        self._open: dict[str, None] = {}
        self._recent: deque[tuple[int, int]] = deque()

    def batch(self, batch: Batch) -> None:
        """A batch has been watched."""
        self.gaps += sum(1 for mark in batch.marks if hasattr(mark, "end_ns"))
        if scans := len(batch.scan_ns):
            self.scans += scans
            self.last_scan_ns = int(batch.scan_ns[-1])
            self._recent.append((self.last_scan_ns, scans))
        elif len(batch):
            self.last_scan_ns = int(batch.time_ns[-1])
        while self._recent and self._recent[0][0] < batch.until_ns - RATE_OVER_NS:
            self._recent.popleft()
        if len(batch) and not batch.image:
            self.changes += len(batch)
            self.last_change_ns = int(batch.time_ns[-1])

    def findings(self, lines: Iterable[str]) -> list[Finding]:
        """Findings have been made; returns those that are new, not changes of state."""
        new = []
        for line in lines:
            finding = decode_finding(line)
            if finding.state in OPEN_STATES and finding.severity != "notice":
                self._open[finding.id] = None
                if len(self._open) > OPEN_AT_MOST:
                    del self._open[next(iter(self._open))]
            else:
                self._open.pop(finding.id, None)
            if finding.id not in self._known:
                self._known.append(finding.id)
                self.severities[finding.severity] += 1
                new.append(finding)
        return new

    @property
    def open_findings(self) -> int:
        """Faults and anomalies that have not returned."""
        return len(self._open)

    def scans_per_s(self) -> float:
        """Scans per second over the last five seconds."""
        if len(self._recent) < 2:
            return 0.0
        span_ns = self._recent[-1][0] - self._recent[0][0]
        scans = sum(scans for _, scans in self._recent) - self._recent[0][1]
        return scans * 1e9 / span_ns if span_ns else 0.0

    def status(self, connection: Connection) -> Status:
        """The present moment."""
        return Status(
            state=connection.state.value,
            source=self._source,
            reason=connection.reason,
            reconnects=connection.reconnects,
            gaps=self.gaps,
            scans=self.scans,
            scans_per_s=round(self.scans_per_s(), 1),
            changes=self.changes,
            last_scan=_iso(self.last_scan_ns),
            last_change=_iso(self.last_change_ns),
            findings=dict(self.severities),
            open=self.open_findings,
        )


def _iso(time_ns: int | None) -> str | None:
    if time_ns is None:
        return None
    moment = datetime.datetime.fromtimestamp(time_ns // 1_000_000_000, datetime.UTC)
    return f"{moment:%Y-%m-%dT%H:%M:%S}.{time_ns // 1_000_000 % 1000:03}Z"
