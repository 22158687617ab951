"""Events per second, beside the paper's own structures and the plain loop; memory; probes."""

import ctypes
import json
import sys
import tempfile
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pyarrow as pa

import runglight as rl
from benches.native import library
from benches.options import Options
from benches.plants import Bodyshop
from benches.plat_baseline import measure as baseline
from benches.stopwatch import Stopwatch, run_and_time
from benches.tables import Table, verdict
from runglight.plants.run import PlantRun

TIMINGS = ("plat", "adaptive")
ROWS_AT_ONCE = 1 << 18
BYTES_PER_STATE = 64
BASELINE_REPEAT = 3
BASELINE_FINDINGS = (
    "unknown", "late", "stalls", "transition_probability", "time_probability", "average_time",
)  # fmt: skip
FLOORS = {"watch": 20.0, "learn": 5.0, "csv": 2.0, "published": 20.0, "o3": 5.0, "memory_mb": 20.0}
"""Million events per second, ratios to the two builds of the baseline, megabytes."""
PROBING_VARIANTS = {
    "double hashing": (),
    "sequential index": ("--index", "sequential"),
    "linear probing, index": ("--index-probing", "linear"),
    "linear probing, devices": ("--device-probing", "linear"),
}


def measure(options: Options) -> dict[str, Any]:
    """One entry per plant."""
    return {size: _measure_plant(options.bodyshop(size), options) for size in options.sizes}


def _measure_plant(plant: Bodyshop, options: Options) -> dict[str, Any]:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        _write_tsv(plant.run.learn, folder / "learn.tsv")
        _write_tsv(plant.run.watch, folder / "watch.tsv")
        models, learning = _learn(plant, options)
        results: dict[str, Any] = {
            "signals": len(plant.learn.signals),
            "devices": plant.run.size.devices,
            "groups": plant.run.size.groups,
            "rules": models["adaptive"].summary()["rules"],
            "learn_events": len(plant.learn),
            "watch_events": len(plant.watch),
            "learn": learning,
        }
        results["baseline_learn"] = {
            build: _rate(baseline.run(build, "learn", folder / "learn.tsv", folder / "rules.tsv"))
            for build in baseline.BUILDS
        }
        results.update(_watch(plant, models, folder, options))
        results["probes"] = _probes(folder)
        results["csv"] = _csv(plant, models, folder, options)
        results["memory"] = _memory(plant, models, folder)
    return results


def _write_tsv(run: PlantRun, path: Path) -> None:
    """As the baseline reads it."""
    names = pl.Series("signal", run.signals)
    columns = {"time": run.time_ns, "signal": names[run.signal_index], "value": run.value}
    pl.DataFrame(columns).write_csv(path, separator="\t", include_header=False)


def _learn(
    plant: Bodyshop, options: Options
) -> tuple[dict[str, rl.NominalModel], dict[str, float]]:
    models, rates = {}, {}
    for timing in TIMINGS:
        watch = Stopwatch()
        for _ in range(1 if options.quick else 2):
            models[timing] = watch.time(partial(rl.learn, plant.learn, timing=timing))
        rates[timing] = len(plant.learn) / watch.best / 1e6
    return models, rates


def _rate(summary: dict[str, Any]) -> float:
    """Million records per second of processor time."""
    return float(summary["records"] / summary["cpu_seconds"] / 1e6)


def _watch(
    plant: Bodyshop, models: dict[str, rl.NominalModel], folder: Path, options: Options
) -> dict[str, Any]:
    """Everything that watches, one after the other, several rounds; the best of each."""
    arrow = pa.table(plant.watch)
    batches = [
        arrow.slice(offset, ROWS_AT_ONCE) for offset in range(0, arrow.num_rows, ROWS_AT_ONCE)
    ]
    ours = {timing: Stopwatch() for timing in TIMINGS}
    from_arrow = {timing: Stopwatch() for timing in TIMINGS}
    loop = PlainLoop(plant.run.watch)
    findings: dict[str, int] = {}
    best: dict[str, float] = dict.fromkeys(baseline.BUILDS, 0.0)
    for _ in range(options.repeat):
        for build in baseline.BUILDS:
            summary = baseline.run(
                build, "watch", folder / "rules.tsv", folder / "watch.tsv",
                "--repeat", str(BASELINE_REPEAT),
            )  # fmt: skip
            best[build] = max(best[build], _rate(summary))
            findings["baseline"] = sum(summary[kind] for kind in BASELINE_FINDINGS)
            for timing, model in models.items():
                for _ in range(BASELINE_REPEAT):
                    # As of the baseline, what is timed is watching alone.
                    watching = partial(_observe, model.monitor(), [plant.watch])
                    findings[timing] = _count(ours[timing].time(watching))
                from_arrow[timing].time(partial(_observe, model.monitor(), batches))
            loop.run()
    events = len(plant.watch) / 1e6
    return {
        "watch": {timing: events / watch.best for timing, watch in ours.items()},
        "watch_arrow": {timing: events / watch.best for timing, watch in from_arrow.items()},
        "baseline_watch": best,
        "loop": events / loop.watch.best,
        "findings": findings,
    }


def _observe(monitor: rl.Monitor, batches: list[Any]) -> list[Any]:
    """Findings, in batches."""
    return [*(monitor.observe(batch) for batch in batches), monitor.finish()]


def _count(findings: list[Any]) -> int:
    return sum(len(batch) for batch in findings)


def _read_and_observe(model: rl.NominalModel, path: Path) -> list[Any]:
    return _observe(model.monitor(), [rl.read_log(path)])


class PlainLoop:
    """One load and store in a table of states per event, compiled: what cannot be beaten."""

    def __init__(self, run: PlantRun) -> None:
        self._loop = library("state_table_loop").state_table_loop
        self._loop.restype = ctypes.c_double
        self._columns = (
            np.ascontiguousarray(run.time_ns, dtype=np.int64),
            np.ascontiguousarray(run.signal_index, dtype=np.uint32),
            np.ascontiguousarray(run.value, dtype=np.int64),
        )
        room = np.zeros((len(run.signals) + 1) * BYTES_PER_STATE, dtype=np.uint8)
        aligned = -room.ctypes.data % BYTES_PER_STATE
        self._states = room[aligned:]
        self.watch = Stopwatch()

    def run(self) -> None:
        """One pass."""
        checksum = ctypes.c_int64()
        columns = [ctypes.c_void_p(column.ctypes.data) for column in self._columns]
        seconds = self._loop(
            *columns,
            ctypes.c_size_t(len(self._columns[0])),
            ctypes.c_void_p(self._states.ctypes.data),
            ctypes.byref(checksum),
        )
        self.watch.seconds.append(seconds)


def _probes(folder: Path) -> dict[str, Any]:
    """Speeds and probe lengths of the paper's variants."""
    results: dict[str, Any] = {}
    for variant, chosen in PROBING_VARIANTS.items():
        rates = {}
        for build in baseline.BUILDS:
            summary = baseline.run(
                build, "watch", folder / "rules.tsv", folder / "watch.tsv",
                "--repeat", str(BASELINE_REPEAT), *chosen,
            )  # fmt: skip
            rates[build] = _rate(summary)
        results[variant] = {
            "rates": rates,
            "probes": summary["probes"],
            "memory_mb": summary["memory_bytes"] / 1e6,
        }
    return results


def _csv(
    plant: Bodyshop, models: dict[str, rl.NominalModel], folder: Path, options: Options
) -> dict[str, Any]:
    """CSV file to findings: in this process, and by the command."""
    path = folder / "watch.csv"
    plant.watch.write(path)
    events = len(plant.watch) / 1e6
    reading = Stopwatch()
    inside = {timing: Stopwatch() for timing in TIMINGS}
    command: dict[str, dict[str, float]] = {}
    for timing, model in models.items():
        model.save(folder / timing)
    for _ in range(options.repeat):
        reading.time(partial(rl.read_log, path))
        for timing, model in models.items():
            inside[timing].time(partial(_read_and_observe, model, path))
            words: list[str | Path] = [
                sys.executable, "-m", "runglight", "watch", folder / timing, path,
                "--format", "jsonl", "-o", folder / "findings.jsonl",
            ]  # fmt: skip
            processor_s, wall_s = run_and_time(words)
            best = command.setdefault(timing, {"processor_s": np.inf, "wall_s": np.inf})
            best["processor_s"] = min(best["processor_s"], processor_s)
            best["wall_s"] = min(best["wall_s"], wall_s)
    return {
        "file_mb": path.stat().st_size / 1e6,
        "read": events / reading.best,
        "inside": {timing: events / watch.best for timing, watch in inside.items()},
        "command": {timing: events / best["processor_s"] for timing, best in command.items()},
        "command_wall": {timing: events / best["wall_s"] for timing, best in command.items()},
    }


def _memory(
    plant: Bodyshop, models: dict[str, rl.NominalModel], folder: Path
) -> dict[str, dict[str, float]]:
    """What a process needs that loads a model and watches, and nothing else."""
    plant.watch.write(folder / "watch.parquet")
    found = {}
    for timing in models:
        words = [sys.executable, "-m", "benches.memory_of_watching"]
        output = folder / f"{timing}.json"
        run_and_time([*words, folder / timing, folder / "watch.parquet", output])
        found[timing] = json.loads(output.read_text(encoding="utf-8"))
    return found


def figures(results: dict[str, Any]) -> list[dict[str, Any]]:
    """Every figure that has a floor: what, value, floor, unit, met."""
    found = []
    for size, plant in results.items():
        for timing in TIMINGS:
            watch = plant["watch_arrow"][timing]
            memory_mb = plant["memory"][timing]["watching_mb"]
            ratios = {
                build: plant["watch"][timing] / plant["baseline_watch"][build]
                for build in baseline.BUILDS
            }
            rows = [
                ("watch, Arrow batches", watch, FLOORS["watch"], "M/s"),
                ("ratio to C++ as published", ratios["published"], FLOORS["published"], "x"),
                ("ratio to C++ -O3", ratios["o3"], FLOORS["o3"], "x"),
                ("learn", plant["learn"][timing], FLOORS["learn"], "M/s"),
                (
                    "CSV to findings, whole command",
                    plant["csv"]["command"][timing],
                    FLOORS["csv"],
                    "M/s",
                ),
                ("memory when watching", memory_mb, FLOORS["memory_mb"], "MB"),
            ]
            for what, value, floor, unit in rows:
                met = value < floor if unit == "MB" else value >= floor
                found.append(
                    {"plant": size, "timing": timing, "what": what, "value": value,
                     "floor": floor, "unit": unit, "met": met}
                )  # fmt: skip
    return found


def demanded(results: dict[str, Any]) -> list[dict[str, Any]]:
    """The same, in words."""
    return [
        {
            "plant": figure["plant"],
            "what": f"{figure['what']}, {figure['timing']}",
            "value": f"{figure['value']:.2f} {figure['unit']}",
            "demand": f"{'<' if figure['unit'] == 'MB' else '≥'} {figure['floor']:g} "
            f"{figure['unit']}",
            "met": figure["met"],
        }
        for figure in figures(results)
    ]


def tables(results: dict[str, Any]) -> list[Table]:
    """The floors, then what they are made of."""
    return [
        _floors(results),
        _speeds(results),
        _limits(results),
        _memories(results),
        _schemes(results),
    ]


def _floors(results: dict[str, Any]) -> Table:
    rows = [
        [each["plant"], each["what"], each["value"], each["demand"], verdict(each["met"])]
        for each in demanded(results)
    ]
    return Table("Floors", ["plant", "figure", "measured", "floor", ""], rows, left=2)


def _speeds(results: dict[str, Any]) -> Table:
    rows = []
    for size, plant in results.items():
        for timing in TIMINGS:
            rows.append(
                [
                    size,
                    f"runglight, {timing}",
                    f"{plant['learn'][timing]:.2f}",
                    f"{plant['watch'][timing]:.2f}",
                    f"{plant['watch_arrow'][timing]:.2f}",
                    f"{plant['csv']['inside'][timing]:.2f}",
                    f"{plant['csv']['command'][timing]:.2f}",
                    f"{plant['csv']['command_wall'][timing]:.2f}",
                    f"{plant['findings'][timing]:,}",
                ]
            )
        for build in baseline.BUILDS:
            rows.append(
                [
                    size,
                    f"C++, {'as published' if build == 'published' else '-O3'}",
                    f"{plant['baseline_learn'][build]:.2f}",
                    f"{plant['baseline_watch'][build]:.2f}",
                    *["-"] * 4,
                    f"{plant['findings']['baseline']:,}",
                ]
            )
        rows.append([size, "plain loop", "-", f"{plant['loop']:.1f}", *["-"] * 5])
        rows.append(
            [size, "CSV reader alone", *["-"] * 3, f"{plant['csv']['read']:.2f}", *["-"] * 3]
        )
    return Table(
        "Million events per second of processor time",
        ["plant", "what", "learn", "watch, columns", "watch, Arrow", "CSV, in process",
         "CSV, command", "the same, wall", "findings"],
        rows,
        left=2,
    )  # fmt: skip


def _limits(results: dict[str, Any]) -> Table:
    rows = [
        [
            size,
            timing,
            f"{plant['watch'][timing] / plant['baseline_watch']['published']:.2f}",
            f"{plant['watch'][timing] / plant['baseline_watch']['o3']:.2f}",
            f"{100 * plant['watch'][timing] / plant['loop']:.1f} %",
            f"{plant['learn'][timing] / plant['baseline_learn']['published']:.2f}",
            f"{plant['learn'][timing] / plant['baseline_learn']['o3']:.2f}",
        ]
        for size, plant in results.items()
        for timing in TIMINGS
    ]
    return Table(
        "Ratios of one run",
        ["plant", "timing", "watch / published", "watch / -O3", "watch / plain loop",
         "learn / published", "learn / -O3"],
        rows,
        left=2,
    )  # fmt: skip


def _memories(results: dict[str, Any]) -> Table:
    rows = [
        [
            size,
            timing,
            f"{memory['loaded_mb']:.2f}",
            f"{memory['watching_mb']:.2f}",
            f"{memory['state_bytes'] / 1e6:.2f}",
            f"{memory['process_mb']:.1f}",
            f"{plant['probes']['double hashing']['memory_mb']:.2f}",
        ]
        for size, plant in results.items()
        for timing, memory in plant["memory"].items()
    ]
    return Table(
        "Memory, MB",
        ["plant", "timing", "model and monitor, loaded", "after watching", "`monitor.state()`",
         "whole process, log and all", "tables of the C++"],
        rows,
        left=2,
    )  # fmt: skip


def _schemes(results: dict[str, Any]) -> Table:
    rows = []
    for size, plant in results.items():
        for variant, found in plant["probes"].items():
            cells = []
            for table in ("index", "device"):
                probes, queries = (
                    found["probes"][table]["probes"],
                    found["probes"][table]["queries"],
                )
                double = plant["probes"]["double hashing"]["probes"][table]["probes"]
                cells += [f"{queries:,}", f"{probes:,}", f"{100 * (probes / double - 1):+.2f} %"]
            speeds = [f"{found['rates'][build]:.2f}" for build in baseline.BUILDS]
            rows.append([size, variant, *speeds, *cells])
    return Table(
        "The paper's tables (Figures 15, 16 and 18 to 21): C++, million records per second, probes",
        ["plant", "variant", "published", "-O3", "index: queries", "probes", "to double hashing",
         "devices: queries", "probes", "to double hashing"],
        rows,
        left=2,
    )  # fmt: skip
