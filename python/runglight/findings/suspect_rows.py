"""One row per suspect, as in Guim & Dias 2023, Table 2: address, class, name, time."""

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from runglight.findings.finding import Finding


class SuspectRow(NamedTuple):
    """A place to look at, and how sure it is: class 1 first."""

    address: str
    rank: int
    name: str
    time: str


def suspect_rows(findings: Iterable[Finding]) -> Iterator[SuspectRow]:
    """The rows of all findings of cycle machines.

    The suspects with the highest score have the class of the finding (1 with an alarm, 3 without);
    those of the other candidates the next one (2 or 4). A finding of class 2 or 4 has no higher.
    """
    for finding in findings:
        if finding.model != "cycle" or finding.rank is None:
            continue
        highest = max((suspect.score or 0.0 for suspect in finding.suspects), default=0.0)
        for suspect in finding.suspects:
            leads = finding.rank in (1, 3) and (suspect.score or 0.0) >= highest
            rank = finding.rank if leads else finding.rank + finding.rank % 2
            yield SuspectRow(suspect.address or "", rank, suspect.signal or "", finding.time)
