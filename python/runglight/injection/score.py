"""How well findings tell the injected faults: found, missed, false, and how soon."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Literal

import msgspec
import numpy as np

from runglight.findings.finding import Finding
from runglight.injection.kinds import SEQUENCE_KINDS, InjectionKind
from runglight.injection.labels import InjectionLabel, nanoseconds

Severities = Literal["fault", "alarm", "any"]

_COUNTED: dict[str, frozenset[str]] = {
    "fault": frozenset({"fault"}),
    "alarm": frozenset({"fault", "anomaly"}),
    "any": frozenset({"fault", "anomaly", "notice"}),
}
_SHIFTS = (InjectionKind.BRANCH_SHIFT, InjectionKind.TIME_SHIFT)
_TELLS: dict[InjectionKind, frozenset[str]] = {
    **dict.fromkeys(SEQUENCE_KINDS, frozenset({"transition", "alarm_path", "stall"})),
    InjectionKind.LATE: frozenset({"late", "stall"}),
    InjectionKind.EARLY: frozenset({"early"}),
    InjectionKind.STALL: frozenset({"stall"}),
    **dict.fromkeys(
        _SHIFTS, frozenset({"transition_probability", "time_probability", "average_time"})
    ),
}
"""Kinds of finding that name a kind of fault."""
_SAYS_NOTHING = frozenset({"gap"})

EARLIER_NS = 20_000_000
"""A finding may stand this much before its label: a scan or two."""


class KindScore(msgspec.Struct, frozen=True):
    """One kind of fault."""

    injected: int
    found: int
    delay_median_s: float | None
    """From when a fault first shows to its finding; None where none was found."""
    delay_most_s: float | None


class Score(msgspec.Struct, frozen=True):
    """All kinds, and the findings that no fault explains."""

    kinds: dict[str, KindScore]
    findings: int
    """Findings of the chosen severity, each counted once."""
    matched: int
    """Findings that name an injected fault."""
    consequences: int
    """Findings of the same incident, or near a fault in its group."""
    false: int
    """Findings that no fault explains."""
    false_by_kind: dict[str, int]
    missed: list[str]
    """Ids of the labels that no finding named."""
    found_by: dict[str, str]
    """Label id to the id of its first finding."""

    @property
    def injected(self) -> int:
        """Faults of all kinds."""
        return sum(kind.injected for kind in self.kinds.values())

    @property
    def found(self) -> int:
        """Faults found, of all kinds."""
        return sum(kind.found for kind in self.kinds.values())


def score(
    labels: Sequence[InjectionLabel],
    findings: Iterable[Finding | Mapping[str, Any]],
    tolerance_s: float = 10.0,
    *,
    severities: Severities = "alarm",
) -> Score:
    """Matches findings with labels.

    A label is found by a finding of its device (a stall: of its group) and of a kind that tells
    of it, from just before the label's time to `tolerance_s` after its end. Other findings in
    that time in that group, and those of an incident that found a label, are consequences; a
    shift, which lasts long, excuses findings of its own device only. What is left is false.
    """
    counted = _counted(findings, _COUNTED[severities])
    spans = _Spans(labels, round(tolerance_s * 1e9))
    found_by: dict[str, _Told] = {}
    matched: set[str] = set()
    incidents: set[str] = set()
    for told in counted:
        for label in spans.around(told.group, told.time_ns):
            if told.time_ns >= label.time_ns - EARLIER_NS and _names(told, label):
                found_by.setdefault(label.id, told)
                matched.add(told.id)
                incidents.add(told.incident)
    consequences = 0
    false: dict[str, int] = {}
    for told in counted:
        if told.id in matched:
            continue
        if told.incident in incidents or spans.excuse(told):
            consequences += 1
        else:
            false[told.kind] = false.get(told.kind, 0) + 1
    return Score(
        kinds=_by_kind(labels, found_by),
        findings=len(counted),
        matched=len(matched),
        consequences=consequences,
        false=sum(false.values()),
        false_by_kind=false,
        missed=[label.id for label in labels if label.id not in found_by],
        found_by={label: told.id for label, told in found_by.items()},
    )


class _Told(msgspec.Struct, frozen=True):
    """What of a finding matters here."""

    id: str
    incident: str
    kind: str
    severity: str
    time: str
    model: str
    group: str | None = None
    device: str | None = None

    @property
    def time_ns(self) -> int:
        return nanoseconds(self.time)


def _counted(
    findings: Iterable[Finding | Mapping[str, Any]], severities: frozenset[str]
) -> list[_Told]:
    """Each finding as it was first told, in time order; later lines only change its state."""
    first: dict[str, _Told] = {}
    for finding in findings:
        told = msgspec.convert(finding, _Told, from_attributes=True, strict=False)
        if told.severity in severities and told.kind not in _SAYS_NOTHING:
            first.setdefault(told.id, told)
    return sorted(first.values(), key=lambda told: told.time_ns)


def _names(told: _Told, label: InjectionLabel) -> bool:
    """True where the finding is of the label's kind, and on its device."""
    if told.kind not in _TELLS[label.kind]:
        return False
    return told.kind == "stall" or label.device is None or told.device == label.device


class _Spans:
    """Labels by group and time."""

    def __init__(self, labels: Sequence[InjectionLabel], tolerance_ns: int) -> None:
        self._groups: dict[str | None, list[tuple[int, int, InjectionLabel]]] = {}
        self._longest: dict[str | None, int] = {}
        for label in labels:
            begin = min(label.start_ns, label.time_ns) - EARLIER_NS
            end = max(label.end_ns, label.time_ns) + tolerance_ns
            if label.kind in _SHIFTS:
                # Shares are checked every so many cycles, and then looked back upon.
                end += (label.end_ns - label.start_ns) // 2
            self._groups.setdefault(label.group, []).append((begin, end, label))
            longest = self._longest.get(label.group, 0)
            self._longest[label.group] = max(longest, end - begin)
        for spans in self._groups.values():
            spans.sort(key=lambda span: span[:2])

    def around(self, group: str | None, time_ns: int) -> list[InjectionLabel]:
        """Labels of a group in whose time a time lies, the earliest first."""
        spans = self._groups.get(group, [])
        longest = self._longest.get(group, 0)
        first = bisect_left(spans, time_ns - longest, key=lambda span: span[0])
        found = []
        for begin, end, label in spans[first:]:
            if begin > time_ns:
                break
            if time_ns <= end:
                found.append(label)
        return found

    def excuse(self, told: _Told) -> bool:
        """True where a fault is near that the finding may follow from."""
        return any(
            label.kind not in _SHIFTS
            or told.device == label.device
            or told.model == "group"
            or told.kind in _TELLS[label.kind]
            for label in self.around(told.group, told.time_ns)
        )


def _by_kind(
    labels: Sequence[InjectionLabel], found_by: Mapping[str, _Told]
) -> dict[str, KindScore]:
    scores = {}
    for kind in InjectionKind:
        of_kind = [label for label in labels if label.kind is kind]
        if not of_kind:
            continue
        delays = [
            (found_by[label.id].time_ns - label.time_ns) / 1e9
            for label in of_kind
            if label.id in found_by
        ]
        scores[str(kind)] = KindScore(
            injected=len(of_kind),
            found=len(delays),
            delay_median_s=float(np.median(delays)) if delays else None,
            delay_most_s=max(delays) if delays else None,
        )
    return scores
