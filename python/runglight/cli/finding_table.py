"""Findings as a table for the person in front of the machine."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import msgspec

from runglight.cli.counted import counted
from runglight.findings.schema import SEVERITIES

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    from runglight.findings.finding import Finding
    from runglight.findings.tally import Tally

STYLES = {"fault": "bold red", "anomaly": "yellow", "notice": "dim"}
CONSEQUENCES_SHOWN = 6
INCIDENTS_SHOWN = 200
SUSPECTS_SHOWN = 3
NARROW = 130
"""Below this many characters, what was expected stands below what happened."""


def newest_lines(findings: Iterable[Finding]) -> list[Finding]:
    """One line per finding: as it was first told, in the state it has come to since."""
    told: dict[str, Finding] = {}
    for finding in findings:
        first = told.setdefault(finding.id, finding)
        told[finding.id] = msgspec.structs.replace(
            first,
            state=finding.state,
            severity=finding.severity,
            rank=finding.rank or first.rank,
            path=finding.path or first.path,
            snapshot_id=finding.snapshot_id or first.snapshot_id,
        )
    return list(told.values())


def incidents_of(findings: Iterable[Finding]) -> list[list[Finding]]:
    """The findings of each incident, first finding first."""
    incidents: dict[str, list[Finding]] = {}
    for finding in findings:
        incidents.setdefault(finding.incident, []).append(finding)
    return list(incidents.values())


def print_findings(console: Console, findings: Sequence[Finding], *, notices: bool) -> None:
    """The table: consequences of one incident below its first finding."""
    incidents = incidents_of(newest_lines(findings))
    # A consequence may be a notice by itself: it is shown below the alarm that explains it.
    shown = [incident for incident in incidents if notices or _alarms(incident)]
    if shown:
        console.print(_table(shown[:INCIDENTS_SHOWN], console.width))
    hidden = len(shown) - INCIDENTS_SHOWN
    if hidden > 0:
        _say(console, f"… and {counted(hidden, 'further incident')}: --format jsonl gives all.")
    quiet = [] if notices else [each for each in incidents if not _alarms(each)]
    if quiet:
        kinds = Counter(finding.kind for incident in quiet for finding in incident)
        _say(
            console,
            f"{counted(kinds.total(), 'notice')} not shown ({_by_kind(kinds)}): "
            "unusual, but nothing the false-alarm budget pays for. --notices shows them.",
            "dim",
        )


def summary_line(tally: Tally, events: int, seconds: float) -> str:
    """`1 fault, 2 anomalies (stall 1, late 2) · 12,345 events in 0.1 s (123,450 events/s)`."""
    severities, alarms = tally.severities(), tally.alarms()
    plurals = {"fault": "faults", "anomaly": "anomalies", "notice": "notices"}
    parts = [
        f"{severities[severity]:,} {severity if severities[severity] == 1 else plurals[severity]}"
        for severity in SEVERITIES
        if severities[severity]
    ]
    told = ", ".join(parts) or "No findings"
    if alarms:
        told += f" ({_by_kind(alarms)})"
    rate = f" ({events / seconds:,.0f} events/s)" if seconds > 0 else ""
    return f"{told} · {counted(events, 'event')} in {seconds:.2f} s{rate}"


def look_first(incident: Sequence[Finding]) -> str:
    """Where to look first: what departed before everything else of the incident."""
    first = incident[0]
    suspect = first.suspects[0] if first.suspects else None
    signal = (suspect and suspect.signal) or first.signal or first.from_state
    address = (suspect and suspect.address) or first.address
    signal = None if signal is None else signal.removeprefix(first.place + "-")
    parts = [first.place]
    if signal:
        parts.append(f"signal {signal}")
    if address and address != first.signal and not (signal and address.endswith(signal)):
        parts.append(f"address {address}")
    return ", ".join(part for part in parts if part)


def suspects_text(finding: Finding) -> str:
    """`I12.2 Clamp2-ADV, I12.4 Clamp3-ADV`, the likeliest first; empty without a class."""
    if finding.rank is None:
        return ""
    group = f"{finding.group}-"
    named = [
        " ".join(filter(None, (each.address, (each.signal or "").removeprefix(group))))
        for each in finding.suspects
    ]
    more = len(named) - SUSPECTS_SHOWN
    return ", ".join(named[:SUSPECTS_SHOWN]) + (f" and {more} more" if more > 0 else "")


def expectation(finding: Finding) -> str:
    """What should have happened, in a few words."""
    prefix = finding.place + "-"
    states = [
        expected.state.removeprefix(prefix)
        + (f" {expected.probability:.0%}" if expected.probability is not None else "")
        for expected in finding.expected[:3]
    ]
    if finding.kind == "stall" and finding.limit_s is not None:
        return f"an event within {_seconds(finding.limit_s)}"
    if finding.kind in {"late", "early"} and finding.limit_s is not None:
        bound = "at least" if finding.kind == "early" else "within"
        took = f", took {_seconds(finding.observed_s)}" if finding.observed_s is not None else ""
        states = [f"{bound} {_seconds(finding.limit_s)}{took}"]
    return " or ".join(states)


def _table(incidents: Sequence[Sequence[Finding]], width: int) -> Table:
    # Loaded where a table is drawn: a program that reads JSON lines need not wait for it.
    from rich import box  # noqa: PLC0415
    from rich.table import Table  # noqa: PLC0415
    from rich.text import Text  # noqa: PLC0415

    narrow = width < NARROW
    ids = [len(finding.id) for incident in incidents for finding in incident]
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("Time (UTC)", no_wrap=True)
    table.add_column("Severity", no_wrap=True)
    table.add_column("Device", overflow="fold")
    table.add_column("What happened", ratio=3, min_width=20)
    if not narrow:
        table.add_column("Expected", ratio=1, min_width=12)
    # Whole: it is what the user types after `runglight confirm`.
    table.add_column("Id", no_wrap=True, min_width=max(ids))
    for incident in incidents:
        stalled = any(finding.kind == "stall" for finding in incident)
        for position, finding in enumerate(incident[: CONSEQUENCES_SHOWN + 1]):
            what = Text(("└ " if position else "") + finding.message)
            if position == 0 and stalled:
                what.append(f"\n→ Look first at {look_first(incident)}.", style="bold")
            if suspects := suspects_text(finding):
                what.append(f"\nSuspects: {suspects}", "dim")
            table.add_row(*_cells(finding, what, narrow=narrow))
        rest = len(incident) - CONSEQUENCES_SHOWN - 1
        if rest > 0:
            table.add_row("", "", "", Text(f"└ and {rest:,} more that follow from it", "dim"))
    return table


def _cells(finding: Finding, what: Text, *, narrow: bool) -> list[Text]:
    from rich.text import Text  # noqa: PLC0415

    severity = Text(finding.severity, STYLES.get(finding.severity, ""))
    if finding.rank is not None:
        severity.append(f"\nclass {finding.rank}")
    if finding.state not in {"suspected", "confirmed"}:
        severity.append(f"\n{finding.state}", "dim")
    time = spoken_time(finding.time)
    place, finding_id = Text(finding.place), Text(finding.id, "dim")
    if not narrow:
        return [Text(time), severity, place, what, Text(expectation(finding)), finding_id]
    if expected := expectation(finding):
        what.append(f"\nExpected: {expected}", "dim")
    return [Text(time.replace(" ", "\n")), severity, place, what, finding_id]


def spoken_time(iso: str) -> str:
    """`2026-01-05T06:12:03.123456789Z` to the millisecond, as people write it."""
    day, _, clock = iso.removesuffix("Z").partition("T")
    whole, _, fraction = clock.partition(".")
    return f"{day} {whole}.{(fraction + '000')[:3]}"


def _alarms(incident: Iterable[Finding]) -> bool:
    return any(finding.severity != "notice" for finding in incident)


def _by_kind(kinds: Counter[str]) -> str:
    return ", ".join(f"{kind} {number:,}" for kind, number in kinds.most_common())


def _seconds(value: float | None) -> str:
    return "" if value is None else f"{value:.2f} s" if value < 100 else f"{value:.0f} s"


def _say(console: Console, sentence: str, style: str = "") -> None:
    from rich.text import Text  # noqa: PLC0415

    console.print(Text(sentence, style), soft_wrap=True)
