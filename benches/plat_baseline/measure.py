"""Measures every variant of the baseline on one pair of logs, as in Figures 15, 16 and 18 to 21.

    python3 measure.py LEARN.tsv WATCH.tsv [--rounds 3] [--json FILE]

Both builds learn; then all variants watch, one after the other, several rounds. Speeds are records
per second of processor time, the best of each: other work on the machine disturbs that least.
"""

import argparse
import json
import subprocess
import tempfile
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parent
BUILDS = ("published", "o3")
VARIANTS = {
    "double hashing": (),
    "sequential index": ("--index", "sequential"),
    "linear probing, index": ("--index-probing", "linear"),
    "linear probing, devices": ("--device-probing", "linear"),
    "linear probing, both": ("--probing", "linear"),
    "double hashing, from file": ("--from-file",),
}
REPEAT = 3


def run(build: str, *arguments: str | Path) -> dict[str, Any]:
    """What one build says of one command."""
    program = FOLDER / "build" / f"plat_baseline_{build}"
    ended = subprocess.run([program, *arguments], capture_output=True, check=True)
    summary: dict[str, Any] = json.loads(ended.stdout)
    return summary


def measure(learn: Path, watch: Path, rounds: int) -> dict[str, Any]:
    """The best run of every build and variant."""
    results: dict[str, Any] = {build: {"learn": {}, "watch": {}} for build in BUILDS}
    with tempfile.TemporaryDirectory() as temporary:
        rules = Path(temporary) / "rules.tsv"
        for _ in range(rounds):
            for build in BUILDS:
                keep_best(results[build], "learn", run(build, "learn", learn, rules))
                for variant, options in VARIANTS.items():
                    summary = run(build, "watch", rules, watch, "--repeat", str(REPEAT), *options)
                    keep_best(results[build]["watch"], variant, summary)
    return results


def keep_best(results: dict[str, Any], name: str, summary: dict[str, Any]) -> None:
    """Keeps a run that took less processor time than the ones before."""
    summary["records_per_second"] = summary["records"] / summary["cpu_seconds"]
    if not results.get(name) or summary["cpu_seconds"] < results[name]["cpu_seconds"]:
        results[name] = summary


def probes(summary: dict[str, Any], table: str) -> str:
    """Slots looked at per query."""
    counts = summary["probes"][table]
    return f"{counts['probes'] / counts['queries']:.3f}"


def print_table(results: dict[str, Any]) -> None:
    """Prints one row per variant."""
    learned = results["o3"]["learn"]
    print(
        f"{learned['signals']:,} signals, {learned['devices']:,} devices, {learned['groups']} "
        f"groups, {learned['rules']:,} rules\n"
    )
    print("| records/s | published | -O3 | probes/query: index | devices | tables, MB |")
    print("|---|---:|---:|---:|---:|---:|")
    speeds = [f"{results[build]['learn']['records_per_second']:,.0f}" for build in BUILDS]
    print(f"| learn | {speeds[0]} | {speeds[1]} | | | |")
    for variant in VARIANTS:
        both = [results[build]["watch"][variant] for build in BUILDS]
        speeds = [f"{summary['records_per_second']:,.0f}" for summary in both]
        size = f"{both[0]['memory_bytes'] / 1e6:.2f}"
        cells = [*speeds, probes(both[0], "index"), probes(both[0], "device"), size]
        print(f"| watch, {variant} | {' | '.join(cells)} |")


def main() -> None:
    """Builds, measures and prints."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("learn", type=Path)
    parser.add_argument("watch", type=Path)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--json", type=Path)
    chosen = parser.parse_args()
    subprocess.run(["make", "-s", "-C", FOLDER], check=True)
    results = measure(chosen.learn, chosen.watch, chosen.rounds)
    print_table(results)
    if chosen.json:
        chosen.json.write_text(json.dumps(results, indent=2) + "\n")


if __name__ == "__main__":
    main()
