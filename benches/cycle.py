"""The cycle machine on the press: `python -m benches.cycle [--only PART ...]`.

Table 3 of Guim & Dias 2023 (fifteen days, 24 failures, 54 stops and variations) in both modes, on
logs of the PLC and over real S7 (`benches.press_s7`), a month without failures, returns from
manual, slower polling with bursts of overload, wear, both models together, and speed. Numbers are
kept in benches/results/cycle.json.
"""

import argparse
import json
import subprocess
import time
from collections import defaultdict
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from msgspec import convert
from rich.console import Console

from benches import press_days, press_s7
from benches.machine import machine
from benches.press_days import Days
from benches.press_scoring import Scored, learned, nanoseconds, scored, watched
from benches.tables import Table, share, verdict
from runglight.configuration import Cycle, Modes, Parameters, cycle_json
from runglight.model import learn_with
from runglight.plants.agenda import NS_PER_S
from runglight.plants.press import MODES, REGIONS, SYMBOLS
from runglight.plants.symbols import symbols_csv

LATEST = Path(__file__).parent / "results" / "cycle.json"
MODES_OF_COMPARING = ("word", "element")

UNSEEN = (12, *range(21, 30))
"""Seeds of fifteen days each that the method had not seen when it was worked out."""

HOUR_NS = 3600 * NS_PER_S

Rows = list[dict[str, Any]]


def total(model: Any, stretches: Iterable[Days]) -> Scored:
    """Table 3 of several stretches together."""
    first, *others = [scored(days, watched(model, days.log)) for days in stretches]
    return sum(others, first)


def table_3() -> Rows:
    """The confusion matrix: the days the method was worked out on, and unseen ones."""
    log = press_days.learned_from().log
    models = {mode: learned(log, mode) for mode in MODES_OF_COMPARING}
    return [
        {"mode": mode, "seed": seed, **total(model, [days]).row()}
        for seed in (press_days.WORKED_OUT_ON, *UNSEEN)
        for days in [press_days.fifteen_days(seed)]
        for mode, model in models.items()
    ]


def stops_unknown() -> Rows:
    """What it costs where no stop with an alarm was learned, or none is taken for normal."""
    days = press_days.fifteen_days()
    ways = {
        "none in what was learned": (press_days.learned_from(stops=()).log, 3),
        "known_stops = 0": (press_days.learned_from().log, 0),
    }
    return [
        {"stops": way, "mode": mode, **total(learned(log, mode, known_stops=known), [days]).row()}
        for way, (log, known) in ways.items()
        for mode in MODES_OF_COMPARING
    ]


def s7() -> Rows:
    """Table 3 over real S7: 7,000 cycles learned, fifteen days watched, polled every 0.15 s."""
    log = press_s7.learned_from().log
    halves = [press_s7.half(name) for name in press_s7.HALVES]
    return [
        {
            "mode": mode,
            "learned": press_s7.learned_from().cycles,
            "days": sum(days.days for days in halves),
            "cycles": sum(days.cycles for days in halves),
            **total(learned(log, mode), halves).row(),
        }
        for mode in MODES_OF_COMPARING
    ]


def month() -> Rows:
    """No failure at all, but stops with alarms: everything of class 1 or 2 is false."""
    log = press_days.learned_from().log
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
                "alarms": sum(_alarms(days) for days in halves),
                "class_1_2": sum(finding.rank in (1, 2) for finding in findings),
                "class_3_4": len({f.id for f in findings if f.rank in (3, 4)}),
                "rising": sum(finding.rank is None for finding in findings),
            }
        )
    return rows


def _alarms(days: Days) -> int:
    """How often the alarm bit rose."""
    _, signal, value = days.log.columns()
    number = days.log.signals.index("Checks-Mode-ALARM")
    return int(((signal == number) & (value == 1)).sum())


def manual() -> Rows:
    """Two hundred returns from manual: a finding within ten seconds of one is false."""
    log = press_days.learned_from().log
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
                "class_3_4": len({f.id for f in findings if f.rank in (3, 4)}),
            }
        )
    return rows


def intervals() -> Rows:
    """Polling over real S7 at 10, 50 and 150 ms, with bursts of overload while watching."""
    rows = []
    for interval_ms in press_s7.INTERVALS_MS:
        log = press_s7.learned_at(interval_ms).log
        for bursts in (False, True):
            days = press_s7.short_days_at(interval_ms, bursts=bursts)
            for mode in MODES_OF_COMPARING:
                row = {"interval_ms": interval_ms, "bursts": bursts, "mode": mode}
                gaps = len(days.log.engine.gaps)
                rows.append({**row, "gaps": gaps, **total(learned(log, mode), [days]).row()})
    return rows


def wear() -> Rows:
    """An end cushion wears out over a day: when a rising rate is told, and when it fails."""
    log = press_days.learned_from().log
    models = {mode: learned(log, mode) for mode in MODES_OF_COMPARING}
    rows: Rows = []
    for device in (*press_days.WORN, None):
        worn = press_days.wearing_out(device)
        for mode, model in models.items():
            findings = watched(model, worn.log)
            rises = [
                nanoseconds(each.time)
                for each in findings
                if each.rank is None and (device is None or each.device == device)
            ]
            ones = [nanoseconds(each.time) for each in findings if each.rank == 1]
            before_h = (ones[0] - rises[0]) / HOUR_NS if ones and rises else None
            rows.append(
                {
                    "worn": device or "nothing",
                    "mode": mode,
                    "cycles": worn.cycles,
                    "notices": len(rises),
                    "class_1": len(ones),
                    "told_h_before": before_h,
                }
            )
    return rows


def witnesses() -> Rows:
    """Both models watch fifteen days: incidents from the beginning of a failure to its alarm."""
    log = press_days.learned_from(cycles=1_000).log
    settings = cycle_json(convert(MODES, Modes), REGIONS, Cycle())
    model = learn_with([log], symbols_csv(SYMBOLS), Parameters(), settings)
    days = press_days.fifteen_days()
    findings = list(model.watch(days.log))
    told = [(nanoseconds(f["time"]), f) for f in findings if f["severity"] != "notice"]
    one = both = several = 0
    for failure in days.happenings:
        if failure.shown_ns is None:
            continue
        seen: dict[str, set[str]] = defaultdict(set)
        until = failure.shown_ns + 5 * NS_PER_S
        for time_ns, finding in told:
            if failure.time_ns <= time_ns <= until:
                seen[finding["incident"]].add(finding["model"])
        models = [each for each in seen.values() if "cycle" in each]
        one += len(seen) == 1
        several += len(seen) > 1
        both += any(len(each) > 1 for each in models)
    modes = sum((f["device"] or "") == "Mode" for f in findings)
    return [
        {
            "failures": one + several,
            "one_incident": one,
            "several_incidents": several,
            "two_witnesses": both,
            "findings_of_mode_bits": modes,
        }
    ]


def speed() -> list[dict[str, Any]]:
    """The engine alone, and learning of the press."""
    log = press_days.learned_from().log
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


PARTS: dict[str, Callable[[], Rows]] = {
    "table_3": table_3,
    "stops_unknown": stops_unknown,
    "s7": s7,
    "month": month,
    "manual": manual,
    "intervals": intervals,
    "wear": wear,
    "witnesses": witnesses,
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
    for row in [*results.get("s7", []), *results.get("table_3", [])]:
        accuracy, found = row["accuracy"], row["true_positive"]
        days = f", seed {row['seed']}" if "seed" in row else ", over S7"
        told = f"{share(accuracy, 1)}, {found} of 24, first {row['first']}"
        if row["mode"] == "word":
            met = accuracy >= 0.92 and found >= 21
            rows.append(["word: accuracy 92 %, 21 of 24" + days, told, verdict(met)])
        else:
            met = found == 24 and row["first"] >= 22
            rows.append(["element: 24 of 24, address first in 22" + days, told, verdict(met)])
    for row in results.get("month", []):
        if row["mode"] == "element":
            false = row["class_1_2"]
            rows.append(
                ["element: no false class 1 or 2 in a month", str(false), verdict(not false)]
            )
    for row in results.get("manual", []):
        false = row["returns_with_a_finding"]
        told = f"{false} of {row['returns']}"
        rows.append([f"{row['mode']}: no finding on return", told, verdict(not false)])
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
    for name in asked.only:
        results[name] = PARTS[name]()
        LATEST.parent.mkdir(parents=True, exist_ok=True)
        LATEST.write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    console = Console()
    if not console.is_terminal:
        console.width = 200
    for table in [*tables(results), verdicts(results)]:
        console.print(table.rich())


if __name__ == "__main__":
    main()
