"""The confusion matrix of Guim & Dias 2023, Table 3, over days of the press."""

import datetime
from dataclasses import asdict, dataclass
from typing import Any

from benches import press_days
from benches.press_days import Days
from runglight.cycle_model import CycleModel
from runglight.findings.finding import Finding, decode_finding
from runglight.findings.suspect_rows import suspect_rows
from runglight.log.changelog import Log
from runglight.model import ROWS_AT_ONCE, learn_cycle
from runglight.plants.agenda import NS_PER_S
from runglight.plants.press import FAILURES, MODES, REGIONS, SYMBOLS
from runglight.plants.symbols import write_symbols

AFTER_ALARM_NS = 5 * NS_PER_S
"""A failure is answered by a finding until so long after its alarm."""

HOUR_NS = 3600 * NS_PER_S
NAME_OF = {symbol.address: symbol.short_name for symbol in SYMBOLS}


@dataclass(frozen=True)
class Scored:
    """Table 3, and whether the address was right."""

    true_positive: int
    false_positive: int
    false_negative: int
    true_negative: int
    first: int
    """Failures whose address stood first."""
    class_1: int
    class_3: int

    @property
    def accuracy(self) -> float:
        """Share of all cases judged rightly."""
        right = self.true_positive + self.true_negative
        return right / (right + self.false_positive + self.false_negative)

    def __add__(self, other: "Scored") -> "Scored":
        """Both stretches together."""
        mine, theirs = asdict(self), asdict(other)
        return Scored(**{name: count + theirs[name] for name, count in mine.items()})

    def row(self) -> dict[str, Any]:
        """For a table."""
        return {**asdict(self), "accuracy": self.accuracy}


def learned(log: Log, mode: str, **parameters: Any) -> CycleModel:
    """The press's cycle machine."""
    symbols = press_days.FOLDER / "symbols.csv"
    symbols.parent.mkdir(parents=True, exist_ok=True)
    write_symbols(SYMBOLS, symbols)
    return learn_cycle(log, MODES, REGIONS, symbols=symbols, mode=mode, **parameters)


def watched(model: CycleModel, log: Log) -> list[Finding]:
    """All lines of a log."""
    monitor = model.monitor()
    lines: list[str] = []
    for offset in range(0, len(log), ROWS_AT_ONCE):
        lines += monitor.observe(log.slice(offset, ROWS_AT_ONCE)).json_lines()
    lines += monitor.finish().json_lines()
    return [decode_finding(line) for line in lines]


def nanoseconds(iso: str) -> int:
    """Of a finding's time."""
    whole, _, fraction = iso.removesuffix("Z").partition(".")
    seconds = int(datetime.datetime.fromisoformat(whole + "+00:00").timestamp())
    return seconds * NS_PER_S + int((fraction + "0" * 9)[:9])


def scored(days: Days, findings: list[Finding]) -> Scored:
    """A failure is found where a class 1 names its address between its beginning and its alarm.

    A class 1 or 2 at any other time is a false positive of the stop or variation before it.
    """
    told = [(nanoseconds(finding.time), finding) for finding in findings]
    ones = [(time_ns, finding) for time_ns, finding in told if finding.rank == 1]
    grave = [(time_ns, finding) for time_ns, finding in told if finding.rank in (1, 2)]
    failures = [each for each in days.happenings if each.kind == "failure" and each.shown_ns]
    answered: set[int] = set()
    found = first = 0
    for failure in failures:
        until = (failure.shown_ns or 0) + AFTER_ALARM_NS
        places = FAILURES[failure.number or 0].shows
        answers = [one for time_ns, one in ones if failure.time_ns <= time_ns <= until]
        answered |= {index for index, (t, _) in enumerate(grave) if failure.time_ns <= t <= until}
        named = {NAME_OF.get(row.address, "") for row in suspect_rows(answers[:1]) if row.rank == 1}
        found += bool(named & set(places))
        top = answers[0].suspects[0] if answers and answers[0].suspects else None
        first += top is not None and NAME_OF.get(top.address or "") in places
    normal = [each for each in days.happenings if each.kind != "failure"]
    stray = [t for index, (t, _) in enumerate(grave) if index not in answered]
    blamed: set[int] = set()
    unblamed = 0
    for time_ns in stray:
        before = [place for place, each in enumerate(normal) if each.time_ns <= time_ns]
        if before and time_ns - normal[before[-1]].time_ns < HOUR_NS:
            blamed.add(before[-1])
        else:
            unblamed += 1
    return Scored(
        true_positive=found,
        false_positive=len(blamed) + unblamed,
        false_negative=len(failures) - found,
        true_negative=len(normal) - len(blamed),
        first=first,
        class_1=len(ones),
        class_3=sum(finding.rank in (3, 4) and finding.state == "suspected" for _, finding in told),
    )
