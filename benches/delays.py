"""Where devices wait for one another: what delays are found, and who is blamed for them."""

from collections import Counter
from collections.abc import Iterable
from datetime import datetime
from typing import Any

import runglight as rl
from benches.accuracy import FALSE_PER_MILLION, LATE_FOUND
from benches.options import Options
from benches.tables import Table, share, verdict
from benches.waiting import PLANTS, simulate
from runglight.moments import nanoseconds

EVENTS = 49_200
QUICK_EVENTS = 12_000
TIMINGS = ("plat", "adaptive")
MILLION = 1e6


def measure(options: Options) -> dict[str, Any]:
    """One entry per plant, what was counted by timing."""
    events = QUICK_EVENTS if options.quick else EVENTS
    results: dict[str, Any] = {}
    for name in options.few(list(PLANTS), ["lines"]):
        counted: dict[str, Counter[str]] = {timing: Counter() for timing in TIMINGS}
        for seed in options.seeds:
            for timing in TIMINGS:
                counted[timing] += _measure_run(name, seed, events, timing)
        results[name] = {timing: dict(counts) for timing, counts in counted.items()}
    return results


def _measure_run(name: str, seed: int, events: int, timing: str) -> Counter[str]:
    _, learned, nominal = simulate(name, seed, events, delayed=False)
    plant, _, delayed = simulate(name, seed, events, delayed=True)
    model = rl.learn(learned, timing=timing)
    false = [said for said in _first(model.watch(nominal)) if _is_alarm(said)]
    told = _first(model.watch(delayed))
    by_place: dict[tuple[int, str], list[dict[str, Any]]] = {}
    for said in told:
        by_place.setdefault((_time_ns(said), f"{said['group']}-{said['device']}"), []).append(said)
    counts = Counter(
        runs=1,
        nominal_events=len(nominal),
        nominal_alarms=len(false),
        nominal_incidents=len({said["incident"] for said in false}),
        alarms=sum(_is_alarm(said) for said in told),
    )
    for delay in plant.delays:
        there = by_place.get((delay.time_ns, delay.device), [])
        alarms = sum(_is_alarm(said) for said in there)
        # An alarm that names a delay is none too many, though the delay could not have been told.
        counts["alarms_of_delays"] += alarms
        if delay.hidden:
            counts["hidden"] += 1
            continue
        counts["delays"] += 1
        counts["by_alarm"] += alarms > 0
        counts["by_anything"] += bool(there)
    return counts


def _first(findings: Iterable[dict[str, Any]]) -> list[dict[str, Any]]:
    first: dict[str, dict[str, Any]] = {}
    for said in findings:
        first.setdefault(said["id"], said)
    return list(first.values())


def _time_ns(said: dict[str, Any]) -> int:
    return nanoseconds(datetime.fromisoformat(said["time"]))


def _is_alarm(said: dict[str, Any]) -> bool:
    return bool(said["severity"] != "notice")


def _judged(timing: str, value: str, met: bool) -> str:
    """With its verdict: nothing was demanded of `plat`."""
    return f"{value} {verdict(met)}" if timing == "adaptive" else value


def tables(results: dict[str, Any]) -> list[Table]:
    """Delays found, and what was cried for nothing."""
    found, false = [], []
    for name, by_timing in results.items():
        for timing, counted in by_timing.items():
            count = Counter(counted)
            found.append(
                [
                    name,
                    timing,
                    f"{count['delays']:,}",
                    _judged(
                        timing,
                        share(count["by_alarm"], count["delays"], 2),
                        count["by_alarm"] >= LATE_FOUND * count["delays"],
                    ),
                    share(count["by_anything"], count["delays"]),
                    f"{count['hidden']:,}",
                    f"{(count['alarms'] - count['alarms_of_delays']) / count['runs']:.1f}",
                ]
            )
            per_million = MILLION * count["nominal_alarms"] / count["nominal_events"]
            false.append(
                [
                    name,
                    timing,
                    f"{count['nominal_events']:,}",
                    f"{count['nominal_alarms']:,}",
                    f"{count['nominal_incidents']:,}",
                    _judged(timing, f"{per_million:,.1f}", per_million <= FALSE_PER_MILLION),
                ]
            )
    return [
        Table(
            "Delays of 1 to 2.5 s where devices wait for one another",
            ["plant", "timing", "delays", "by an alarm", "by anything", "hidden in another time",
             "other alarms a run"],
            found,
            left=2,
        ),
        Table(
            "The same plants, nominal",
            ["plant", "timing", "events watched", "alarms", "incidents", "alarms per million"],
            false,
            left=2,
        ),
    ]  # fmt: skip
