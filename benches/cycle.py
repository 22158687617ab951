"""The cycle machine on the press: `python -m benches.cycle [--only PART ...]`.

Table 3 of Guim & Dias 2023 (fifteen days, 24 failures, 54 stops and variations) in both modes, a
month without failures, returns from manual, slower polling with bursts of overload, and speed.
Numbers are kept in benches/results/cycle.json.
"""

import argparse
import json
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console

from benches import press_days
from benches.machine import machine
from benches.press_days import Days, polled
from benches.tables import Table, share, verdict
from runglight.cycle_model import CycleModel
from runglight.findings.finding import Finding, decode_finding
from runglight.findings.suspect_rows import suspect_rows
from runglight.log.changelog import Log
from runglight.model import ROWS_AT_ONCE, learn_cycle
from runglight.plants.agenda import NS_PER_S
from runglight.plants.press import FAILURES, MODES, REGIONS, SYMBOLS
from runglight.plants.symbols import write_symbols

LATEST = Path(__file__).parent / "results" / "cycle.json"
MODES_OF_COMPARING = ("word", "element")
AFTER_ALARM_NS = 5 * NS_PER_S
"""A failure is answered by a finding until so long after its alarm."""

SEEDS = (press_days.WORKED_OUT_ON, 12)
"""Fifteen days each; the second is what the method had not seen when it was worked out."""

INTERVALS_MS = (10, 50, 150)
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


def learned(log: Log, mode: str) -> CycleModel:
    """The press's cycle machine."""
    symbols = press_days.FOLDER / "symbols.csv"
    symbols.parent.mkdir(parents=True, exist_ok=True)
    write_symbols(SYMBOLS, symbols)
    return learn_cycle(log, MODES, REGIONS, symbols=symbols, mode=mode)


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
    import datetime  # noqa: PLC0415

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
        if before and time_ns - normal[before[-1]].time_ns < 3600 * NS_PER_S:
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


def table_3(log: Log) -> list[dict[str, Any]]:
    """The confusion matrix in both modes."""
    models = {mode: learned(log, mode) for mode in MODES_OF_COMPARING}
    return [
        {"mode": mode, "seed": seed, **_as_row(scored(days, watched(model, days.log)))}
        for seed in SEEDS
        for days in [press_days.fifteen_days(seed)]
        for mode, model in models.items()
    ]


def _as_row(result: Scored) -> dict[str, Any]:
    return {**result.__dict__, "accuracy": result.accuracy}


def month(log: Log) -> list[dict[str, Any]]:
    """No failure at all: everything of class 1 or 2 is false."""
    halves = press_days.sound_month()
    rows = []
    for mode in MODES_OF_COMPARING:
        model = learned(log, mode)
        findings = [finding for days in halves for finding in watched(model, days.log)]
        rows.append(
            {
                "mode": mode,
                "days": sum(days.days for days in halves),
                "cycles": sum(days.cycles for days in halves),
                "class_1_2": sum(finding.rank in (1, 2) for finding in findings),
                "class_3_4": len({f.id for f in findings if f.rank in (3, 4)}),
                "rising": sum(finding.rank is None for finding in findings),
            }
        )
    return rows


def manual(log: Log) -> list[dict[str, Any]]:
    """Two hundred returns from manual: a finding within ten seconds of one is false."""
    days = press_days.manual_returns()
    number = days.log.signals.index("Checks-Mode-MANUAL")
    time_ns, signal, value = days.log.columns()
    returns = time_ns[(signal == number) & (value == 0)][1:]
    rows = []
    for mode in MODES_OF_COMPARING:
        findings = [f for f in watched(learned(log, mode), days.log) if f.state != "returned"]
        times = [nanoseconds(finding.time) for finding in findings]
        rows.append(
            {
                "mode": mode,
                "returns": len(returns),
                "returns_with_a_finding": sum(
                    any(0 <= t - back < 10 * NS_PER_S for t in times) for back in returns.tolist()
                ),
                "class_1_2": sum(finding.rank in (1, 2) for finding in findings),
                "class_3_4": sum(finding.rank in (3, 4) for finding in findings),
            }
        )
    return rows


def intervals(log: Log) -> list[dict[str, Any]]:
    """Slower polling, in learning and watching, with bursts of overload while watching."""
    days = press_days.fifteen_days()
    rows = []
    for interval_ms in INTERVALS_MS:
        interval_ns = interval_ms * 1_000_000
        slow = polled(log, interval_ns, bursts=False)
        for bursts in (False, True):
            seen = Days(
                polled(days.log, interval_ns, bursts=bursts),
                days.happenings,
                days.days,
                days.cycles,
            )
            for mode in MODES_OF_COMPARING:
                result = scored(seen, watched(learned(slow, mode), seen.log))
                row = {"interval_ms": interval_ms, "bursts": bursts, "mode": mode}
                rows.append({**row, **_as_row(result)})
    return rows


def speed(log: Log) -> list[dict[str, Any]]:
    """The engine alone, and learning of the press."""
    root = Path(__file__).parent.parent
    command = ["cargo", "run", "--release", "-q", "-p", "runglight-engine", "--example", "cycle"]
    engine = subprocess.run(command, cwd=root, check=True, capture_output=True, text=True)
    took = []
    for _ in range(3):
        began = time.perf_counter()
        learned(log, "element")
        took.append(time.perf_counter() - began)
    model = learned(log, "element")
    monitor = model.monitor()
    began = time.perf_counter()
    monitor.observe(log)
    watching_s = time.perf_counter() - began
    return [
        {
            "words_per_s": json.loads(engine.stdout)["words_per_s"],
            "learning_s": min(took),
            "rows": len(log),
            "sequences": model.summary()["sequences"],
            "press_rows_per_s": len(log) / watching_s,
        }
    ]


PARTS: dict[str, Callable[[Log], list[dict[str, Any]]]] = {
    "table_3": table_3,
    "month": month,
    "manual": manual,
    "intervals": intervals,
    "speed": speed,
}


def tables(results: dict[str, Any]) -> list[Table]:
    """What was measured, for a terminal."""
    shown = []
    for name, rows in results.items():
        if name in PARTS and rows:
            columns = list(rows[0])
            cells = [[_cell(row[column]) for column in columns] for row in rows]
            shown.append(Table(name, columns, cells))
    return shown


def _cell(value: object) -> str:
    if isinstance(value, float):
        return f"{value:,.3f}" if value < 1000 else f"{value:,.0f}"
    return f"{value:,}" if isinstance(value, int) and not isinstance(value, bool) else str(value)


def verdicts(results: dict[str, Any]) -> Table:
    """What was demanded."""
    rows: list[list[str]] = []
    for row in results.get("table_3", []):
        accuracy, found = row["accuracy"], row["true_positive"]
        days = f", seed {row['seed']}"
        if row["mode"] == "word":
            met = accuracy >= 0.92 and found >= 21
            rows.append(["word: accuracy 92 %, 21 of 24" + days, verdict(met)])
        else:
            met = found == 24 and row["first"] >= 22
            rows.append(["element: 24 of 24, address first in 22" + days, verdict(met)])
        rows[-1].insert(1, f"{share(accuracy, 1)}, {found} of 24, first {row['first']}")
    for row in results.get("month", []):
        if row["mode"] == "element":
            false = row["class_1_2"]
            rows.append(
                ["element: no false class 1 or 2 in a month", str(false), verdict(not false)]
            )
    for row in results.get("manual", []):
        if row["mode"] == "element":
            false = row["returns_with_a_finding"]
            told = f"{false} of {row['returns']}"
            rows.append(["element: no finding on return from manual", told, verdict(not false)])
    for row in results.get("speed", []):
        words, learning_s = row["words_per_s"], row["learning_s"]
        rows.append(["20 M words/s", f"{words / 1e6:.1f} M", verdict(words >= 20e6)])
        rows.append(["learning under 1 s", f"{learning_s:.2f} s", verdict(learning_s < 1)])
    return Table("Demanded", ["what", "measured", "verdict"], rows)


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--only", nargs="+", choices=list(PARTS), default=list(PARTS))
    asked = parser.parse_args()
    results = json.loads(LATEST.read_text(encoding="utf-8")) if LATEST.is_file() else {}
    results["machine"] = machine()
    log = press_days.learned_from().log
    for name in asked.only:
        results[name] = PARTS[name](log)
        LATEST.parent.mkdir(parents=True, exist_ok=True)
        LATEST.write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    console = Console()
    if not console.is_terminal:
        console.width = 200
    for table in [*tables(results), verdicts(results)]:
        console.print(table.rich())


if __name__ == "__main__":
    main()
