"""Is the budget honest? False alarms a day against `--false-alarms`, and what each budget finds."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import runglight as rl
from benches.options import Options
from benches.plants import bodyshop, cell, days, split
from benches.poisson import lower_bound, upper_bound
from benches.recordings import read, recordings
from benches.tables import Table, share
from runglight.injection import Injected, InjectionPlan, inject_with, score

BUDGETS = (0.1, 1.0, 10.0)
CURVE = (0.01, 0.1, 1.0, 10.0, 100.0, 1000.0)
LEARN_SHARE = 0.6
FOLDS = 5
ANSWERS = ("kept", "not refuted", "broken")
CELL_CYCLES = 600
TINY_EVENTS = 400_000
PLAN = InjectionPlan(faults=150, late=150, early=50)

Part = tuple[list[rl.Log], rl.Log]
"""Logs to learn from, and the log to watch."""


@dataclass(frozen=True)
class Source:
    """Where nominal logs come from."""

    name: str
    parts: Callable[[], list[Part]]


def sources(options: Options) -> list[Source]:
    """Simulated plants, then recordings cut into folds."""
    seeds = options.seeds

    def cells() -> list[Part]:
        cycles = 100 if options.quick else CELL_CYCLES
        return [_cut(cell(cycles, seed)) for seed in seeds]

    def tiny() -> list[Part]:
        events = 60_000 if options.quick else TINY_EVENTS
        return [_bodyshop("tiny", seed, events) for seed in seeds]

    found = [Source(f"cell, {len(seeds)} seeds", cells),
             Source(f"bodyshop tiny, {len(seeds)} seeds", tiny)]  # fmt: skip
    if not options.quick:
        found.append(Source("bodyshop a, 1 seed", lambda: [_bodyshop("a", 1, 3_700_000)]))
    for name, path in list(recordings().items())[: 1 if options.quick else None]:
        found.append(Source(name, partial(_folds_of, path)))
    return found


def _cut(log: rl.Log) -> Part:
    learned, watched = split(log, LEARN_SHARE)
    return [learned], watched


def _bodyshop(size: str, seed: int, events: int) -> Part:
    learned = round(LEARN_SHARE * events)
    plant = bodyshop(size, seed, learned, events - learned)
    return [plant.learn], plant.watch


def _folds_of(path: Path) -> list[Part]:
    return list(folds(read(path)))


def _cut_of(path: Path) -> list[Part]:
    return [_cut(read(path))]


def folds(log: rl.Log) -> Iterator[Part]:
    """Each fifth of a log in turn is watched, by what the others taught."""
    bounds = [round(len(log) * fold / FOLDS) for fold in range(FOLDS + 1)]
    for start, end in pairwise(bounds):
        others = [log.slice(0, start), log.slice(end)]
        yield [each for each in others if len(each)], log.slice(start, end - start)


def measure(options: Options) -> dict[str, Any]:
    """False alarms of each source at each budget, and the operating curves."""
    rates: dict[str, Any] = {}
    curves: dict[str, Any] = {}
    for source in sources(options):
        parts = source.parts()
        rates[source.name] = {str(budget): _alarms(parts, budget) for budget in BUDGETS} | {
            "plat": _alarms(parts, None)
        }
    for source in _curve_sources(options):
        curves[source.name] = _curve(source.parts(), options)
    return {"rates": rates, "curves": curves}


def _alarms(parts: list[Part], budget: float | None) -> dict[str, float]:
    total: dict[str, float] = {"alarms": 0, "incidents": 0, "notices": 0, "days": 0.0, "events": 0}
    for learned, watched in parts:
        said = _said(_model(learned, budget), watched)
        for key, value in said.items():
            total[key] += value
        total["days"] += days(watched)
        total["events"] += len(watched)
    return total


def _model(learned: list[rl.Log], budget: float | None) -> rl.NominalModel:
    if budget is None:
        return rl.learn(learned, timing="plat")
    return rl.learn(learned, false_alarms_per_day=budget)


def _said(model: rl.NominalModel, log: rl.Log) -> dict[str, int]:
    severity: dict[str, str] = {}
    incident: dict[str, str] = {}
    for finding in model.watch(log):
        severity.setdefault(finding["id"], finding["severity"])
        incident.setdefault(finding["id"], finding["incident"])
    alarms = [finding for finding, said in severity.items() if said != "notice"]
    return {
        "alarms": len(alarms),
        "incidents": len({incident[finding] for finding in alarms}),
        "notices": len(severity) - len(alarms),
    }


def _curve_sources(options: Options) -> list[Source]:
    """A few, with less of each: every one is learned and watched at every budget."""
    few = range(1, 2 if options.quick else 4)
    found = [
        Source("cell", lambda: [_cut(cell(100 if options.quick else 300, n)) for n in few]),
        Source("bodyshop tiny", lambda: [_bodyshop("tiny", n, 60_000) for n in few]),
    ]
    real = recordings()
    for name in ("vps_filling/Filling_ALL", "smartfactory_owl_conveyor/log2",
                 "atspm_signal/sample_raw_data"):  # fmt: skip
        if name in real and not options.quick:
            found.append(Source(name, partial(_cut_of, real[name])))
    return found


def _curve(parts: list[Part], options: Options) -> list[dict[str, float]]:
    seeds = range(1, 2 if options.quick else 4)
    injected: list[tuple[list[rl.Log], rl.Log, list[Injected]]] = []
    for learned, watched in parts:
        placing = rl.learn([watched, *learned], timing="plat")
        faulty = [
            inject_with(watched, replace(PLAN, seed=seed), placing, learned)
            for seed in (seeds if len(parts) == 1 else seeds[:1])
        ]
        injected.append((learned, watched, faulty))
    points = []
    for budget in CURVE:
        point: dict[str, float] = {"budget": budget, "days": 0.0, "false_alarms": 0,
                                   "injected": 0, "alarms": 0, "any": 0}  # fmt: skip
        for learned, watched, faulty in injected:
            model = _model(learned, budget)
            point["days"] += days(watched)
            point["false_alarms"] += _said(model, watched)["alarms"]
            for each in faulty:
                findings = list(model.watch(each.log))
                point["injected"] += len(each.labels)
                point["alarms"] += score(each.labels, findings).found
                point["any"] += score(each.labels, findings, severities="any").found
        points.append(point)
    return points


def judged(found: dict[str, float], budget: float) -> str:
    """Whether what was counted speaks for or against the budget."""
    count, watched_days = int(found["alarms"]), found["days"]
    if lower_bound(count) / watched_days > budget:
        return "**broken**"
    return "kept" if upper_bound(count) / watched_days <= budget else "not refuted"


def tables(results: dict[str, Any]) -> list[Table]:
    """Rates against budgets, then what each budget finds."""
    rows = []
    for source, found in results["rates"].items():
        for budget in map(str, BUDGETS):
            said = found[budget]
            rows.append(
                [
                    source,
                    f"{float(budget):g}",
                    _duration(said["days"]),
                    f"{said['alarms']:,}",
                    f"{said['incidents']:,}",
                    f"{said['alarms'] / said['days']:,.2f}",
                    f"{lower_bound(int(said['alarms'])) / said['days']:,.2f} to "
                    f"{upper_bound(int(said['alarms'])) / said['days']:,.2f}",
                    judged(said, float(budget)),
                    f"{found['plat']['alarms']:,}",
                ]
            )
    curve = [
        [
            source,
            f"{point['budget']:g}",
            share(point["alarms"], point["injected"]),
            share(point["any"], point["injected"]),
            f"{point['injected']:,}",
            f"{point['false_alarms']:,} in {_duration(point['days'])}",
        ]
        for source, points in results["curves"].items()
        for point in points
    ]
    return [
        Table(
            "False alarms a day on nominal logs, against the budget",
            ["source", "budget a day", "watched", "alarms", "incidents", "alarms a day",
             "95 % bounds", "budget", "alarms of plat"],
            rows,
        ),
        Table(
            "The operating curve: injected faults found at each budget",
            ["source", "budget a day", "found by alarms", "by anything", "injected",
             "false alarms on the nominal part"],
            curve,
        ),
    ]  # fmt: skip


def _duration(in_days: float) -> str:
    if in_days >= 1:
        return f"{in_days:.2f} days"
    hours = 24 * in_days
    return f"{hours:.1f} h" if hours >= 1 else f"{60 * hours:.1f} min"
