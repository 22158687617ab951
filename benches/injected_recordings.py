"""Faults put into real recordings, and what is said of the part in which nothing was put."""

from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import runglight as rl
from benches.options import Options
from benches.plants import days, split
from benches.recordings import read, recordings
from benches.tables import Table, share
from runglight.injection import InjectionPlan, inject_with, score

LEARN_SHARE = 0.6
EACH = 150
STALLS = 5
PLANS = {
    "faults of order": InjectionPlan(faults=EACH),
    "late": InjectionPlan(late=EACH),
    "early": InjectionPlan(early=EACH),
    "stalls": InjectionPlan(stalls=STALLS),
}
"""Each kind alone, so that none takes another's room."""
VARIANTS: dict[str, dict[str, Any]] = {
    "plat": {"timing": "plat"},
    "adaptive": {"false_alarms_per_day": 1.0},
}
KINDS_SHOWN = 3


def measure(options: Options) -> dict[str, Any]:
    """One entry per recording that is there."""
    chosen = list(recordings().items())[: 1 if options.quick else None]
    return {name: _measure_recording(path, options) for name, path in chosen}


def _measure_recording(path: Path, options: Options) -> dict[str, Any]:
    log = read(path)
    learned, watched = split(log, LEARN_SHARE)
    models = {name: rl.learn(learned, **chosen) for name, chosen in VARIANTS.items()}
    placing = rl.learn([watched, learned], timing="plat")
    injected: dict[str, Any] = {}
    for kind, plan in PLANS.items():
        counts = {name: Counter[str]() for name in models}
        for seed in options.seeds:
            made = inject_with(watched, replace(plan, seed=seed), placing, [learned])
            for name, model in models.items():
                findings = list(model.watch(made.log))
                for severities in ("alarm", "any"):
                    told = score(made.labels, findings, severities=severities)
                    counts[name][f"{severities}_found"] += told.found
                    counts[name][f"{severities}_false"] += told.false
                counts[name]["injected"] += len(made.labels)
        injected[kind] = {name: dict(each) for name, each in counts.items()}
    summary = models["adaptive"].summary()
    return {
        "events": len(log),
        "days": days(log),
        "signals": len(log.signals),
        "devices": summary["devices"],
        "watched_events": len(watched),
        "seeds": len(options.seeds),
        "nominal": {name: _nominal(model, watched) for name, model in models.items()},
        "injected": injected,
    }


def _nominal(model: rl.NominalModel, watched: rl.Log) -> dict[str, Any]:
    first: dict[str, dict[str, Any]] = {}
    for finding in model.watch(watched):
        first.setdefault(finding["id"], finding)
    alarms = [each for each in first.values() if each["severity"] != "notice"]
    kinds = Counter(each["kind"] for each in first.values())
    return {
        "alarms": len(alarms),
        "notices": len(first) - len(alarms),
        "kinds": dict(kinds.most_common()),
    }


def tables(results: dict[str, Any]) -> list[Table]:
    """Detection by kind, then findings where nothing was put."""
    if not results:
        return []
    return [_detection(results), _nominal_table(results)]


def _detection(results: dict[str, Any]) -> Table:
    rows = []
    for recording, found in results.items():
        for name in VARIANTS:
            cells = []
            false = said = 0
            for kind in PLANS:
                of_kind = found["injected"][kind][name]
                injected = of_kind["injected"]
                alarm, said_any = of_kind["alarm_found"], of_kind["any_found"]
                cells.append(
                    f"{share(alarm, injected, 0)} ({share(said_any, injected, 0)}) of {injected}"
                    if injected
                    else "no room"
                )
                false += of_kind["alarm_false"]
                said += of_kind["any_false"]
            runs = found["seeds"] * len(PLANS)
            rows.append([recording, name, *cells, f"{false / runs:.1f}", f"{said / runs:.1f}"])
    return Table(
        "Injected into recordings: found by alarms (by any severity) of all injected",
        ["recording", "timing", *PLANS, "false alarms a run", "false findings a run"],
        rows,
        left=2,
    )


def _nominal_table(results: dict[str, Any]) -> Table:
    rows = []
    for recording, found in results.items():
        thousand = found["watched_events"] / 1000
        for name, said in found["nominal"].items():
            shown = list(said["kinds"].items())[:KINDS_SHOWN]
            rows.append(
                [
                    recording,
                    name,
                    ", ".join(f"{kind} {count:,}" for kind, count in shown) or "-",
                    f"{found['devices']}",
                    f"{found['watched_events']:,}",
                    f"{24 * 60 * found['days']:.1f}",
                    f"{said['alarms'] / thousand:.1f}",
                    f"{said['notices'] / thousand:.1f}",
                ]
            )
    return Table(
        "Learned on 60 % of a recording, watched on the rest: findings per 1,000 events",
        ["recording", "timing", "most frequent kinds", "devices", "events watched",
         "minutes, all", "alarms", "notices"],
        rows,
        left=3,
    )  # fmt: skip
