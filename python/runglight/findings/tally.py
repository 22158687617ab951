"""How many findings there are, by what they are: a finding that is told again counts once."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from runglight.findings.finding import Finding


class Tally:
    """Counts findings as they are told; one that changes its state counts as it stands at last."""

    def __init__(self) -> None:
        self._kind_of: dict[str, str] = {}
        self._severity_of: dict[str, str] = {}

    @classmethod
    def of(cls, findings: Iterable[Finding]) -> Tally:
        """The findings counted."""
        tally = cls()
        told = [(finding.id, finding.kind, finding.severity) for finding in findings]
        tally.add(*([each[column] for each in told] for column in range(3)))
        return tally

    def add(self, ids: Sequence[str], kinds: Sequence[str], severities: Sequence[str]) -> None:
        """Counts findings by their ids, kinds and severities, in the order they were told."""
        self._severity_of.update(zip(ids, severities, strict=True))
        kind_of = self._kind_of
        for finding_id, kind in zip(ids, kinds, strict=True):
            kind_of.setdefault(finding_id, kind)

    def severities(self) -> Counter[str]:
        """The number of findings of each severity."""
        return Counter(self._severity_of.values())

    def alarms(self) -> Counter[str]:
        """The number of findings of each kind, of those that are more than a notice."""
        severity_of = self._severity_of
        return Counter(
            kind for each, kind in self._kind_of.items() if severity_of[each] != "notice"
        )
