"""Incidents: what one cause did, and what people did about it, as ISA-18.2 has alarms.

An incident stands while one of its faults or anomalies does. It is *unacknowledged* until somebody
has seen it, *acknowledged* after that, *returned* where the machine came back and nobody has seen
it yet, and *closed* once both is true. *Shelved* means: quiet until a time, this incident and
whatever else the same device does of the same kind.
"""

from __future__ import annotations

import datetime
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import msgspec

from runglight.findings.acts import Act
from runglight.findings.finding import Finding, decode_finding, full_name
from runglight.findings.schema import SEVERITIES

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

State = Literal["unacknowledged", "acknowledged", "returned", "shelved", "closed"]
OPEN: frozenset[State] = frozenset({"unacknowledged", "acknowledged", "returned"})

STANDING = frozenset({"suspected", "confirmed"})
MOMENTARY = frozenset(
    {"late", "early", "transition_probability", "time_probability", "average_time", "gap"}
)
"""Kinds that are over when they are told: nothing returns from them."""
KEPT_AT_MOST = 5000


class Deed(msgspec.Struct, frozen=True):
    """Who did it, when, and until when it holds."""

    who: str
    time: str
    until: str | None = None


class Summary(msgspec.Struct, frozen=True):
    """One line of the list of incidents."""

    id: str
    time: str
    last: str
    severity: str
    state: State
    kind: str
    group: str | None
    device: str | None
    place: str
    message: str
    look_first: str
    findings: int
    acknowledged: Deed | None
    shelved: Deed | None
    accepted: Deed | None


@dataclass
class Incident:
    """One incident, as it grows."""

    id: str
    of_this_run: bool
    """False where only the store knows it: whether it still stands, nobody can say."""
    findings: dict[str, Finding] = field(default_factory=dict)
    """The newest line of each that is no operator's."""
    acknowledged: Deed | None = None
    accepted: Deed | None = None
    shelved: Deed | None = None

    @property
    def leading(self) -> Finding:
        """The gravest finding; of several, the first."""
        return min(
            self.findings.values(), key=lambda each: (SEVERITIES.index(each.severity), each.time)
        )

    @property
    def alarm(self) -> tuple[str, str]:
        """What is shelved when this is: a place and a kind."""
        return self.leading.place, self.leading.kind

    @property
    def stands(self) -> bool:
        """Whether the machine has not come back yet."""
        return any(
            each.state in STANDING and each.kind not in MOMENTARY and each.severity != "notice"
            for each in self.findings.values()
        )


class Incidents:
    """All incidents, from findings and acts; the newest thousands."""

    def __init__(self, now: Callable[[], datetime.datetime] | None = None) -> None:
        self._now = now or (lambda: datetime.datetime.now(datetime.UTC))
        self._incidents: dict[str, Incident] = {}
        self._of_finding: dict[str, str] = {}
        self._shelves: dict[tuple[str, str], Deed] = {}

    def take(self, lines: Iterable[str], *, of_this_run: bool = True) -> list[str]:
        """Takes findings; the ids of the incidents they changed, in order."""
        changed: dict[str, None] = {}
        for line in lines:
            finding = decode_finding(line)
            incident = self._incidents.get(finding.incident)
            if incident is None:
                incident = self._begin(finding, of_this_run=of_this_run)
            incident.of_this_run = incident.of_this_run or of_this_run
            if finding.state == "acknowledged":
                # By another door (`runglight confirm`); who it was is not known there.
                incident.acknowledged = incident.acknowledged or Deed("", finding.time)
                if finding.id not in incident.findings:
                    incident.findings[finding.id] = finding
            else:
                incident.findings[finding.id] = finding
            self._of_finding[finding.id] = incident.id
            changed[incident.id] = None
        return list(changed)

    def act(self, acts: Iterable[Act]) -> list[str]:
        """Takes what operators did; the ids of the incidents that changed."""
        changed: dict[str, None] = {}
        for act in acts:
            incident = self._incidents.get(act.incident)
            if incident is None:
                continue
            deed = Deed(act.who, act.time, act.until)
            if act.deed == "acknowledge":
                incident.acknowledged = deed
            elif act.deed == "accept":
                incident.accepted = deed
                incident.acknowledged = incident.acknowledged or deed
            else:
                shelf = deed if act.deed == "shelve" else None
                changed |= dict.fromkeys(self._shelve(incident, shelf))
            changed[incident.id] = None
        return list(changed)

    def get(self, incident_id: str) -> Incident | None:
        """One incident."""
        return self._incidents.get(incident_id)

    def of_finding(self, finding_id: str) -> Incident | None:
        """The incident of a finding."""
        return self._incidents.get(self._of_finding.get(finding_id, ""))

    def state(self, incident: Incident) -> State:
        """Where it stands, now."""
        if self._is_shelved(incident):
            return "shelved"
        if incident.acknowledged is None:
            return "unacknowledged" if incident.stands else "returned"
        return "acknowledged" if incident.stands and incident.of_this_run else "closed"

    def summaries(self) -> list[Summary]:
        """All of them, the newest first."""
        return [self.summary(each) for each in reversed(self._incidents.values())]

    def open(self) -> list[Incident]:
        """Those that concern somebody: neither closed nor shelved, and more than a notice."""
        return [
            each
            for each in self._incidents.values()
            if each.leading.severity != "notice" and self.state(each) in OPEN
        ]

    def shelf_ends(self) -> list[str]:
        """Ids of incidents whose shelf time has just ended; they are off the shelf now."""
        ended = []
        for incident in self._incidents.values():
            if incident.shelved is not None and not self._is_shelved(incident):
                incident.shelved = None
                ended.append(incident.id)
        return ended

    def summary(self, incident: Incident) -> Summary:
        """One line of the list."""
        leading = incident.leading
        suspect = leading.suspects[0] if leading.suspects else None
        look = (
            [leading.signal, leading.address]
            if suspect is None
            else [suspect.signal, suspect.address]
        )
        return Summary(
            id=incident.id,
            time=min(each.time for each in incident.findings.values()),
            last=max(each.time for each in incident.findings.values()),
            severity=leading.severity,
            state=self.state(incident),
            kind=leading.kind,
            group=leading.group,
            device=leading.device,
            place=leading.place,
            message=leading.message,
            look_first=" ".join(part for part in look if part),
            findings=len(incident.findings),
            acknowledged=incident.acknowledged,
            shelved=incident.shelved if self._is_shelved(incident) else None,
            accepted=incident.accepted,
        )

    def _begin(self, finding: Finding, *, of_this_run: bool) -> Incident:
        incident = Incident(finding.incident, of_this_run)
        self._incidents[finding.incident] = incident
        shelf = self._shelves.get((full_name(finding.group, finding.device), finding.kind))
        incident.shelved = shelf
        if len(self._incidents) > KEPT_AT_MOST:
            oldest = next(iter(self._incidents))
            for finding_id in self._incidents.pop(oldest).findings:
                self._of_finding.pop(finding_id, None)
        return incident

    def _shelve(self, incident: Incident, shelf: Deed | None) -> list[str]:
        alarm = incident.alarm
        if shelf is None:
            self._shelves.pop(alarm, None)
        else:
            self._shelves[alarm] = shelf
        same = [each for each in self._incidents.values() if each.alarm == alarm]
        for each in same:
            each.shelved = shelf
        return [each.id for each in same]

    def _is_shelved(self, incident: Incident) -> bool:
        shelf = incident.shelved
        if shelf is None or shelf.until is None:
            return False
        return datetime.datetime.fromisoformat(shelf.until) > self._now()
