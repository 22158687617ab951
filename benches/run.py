"""Measures everything: `python -m benches.run [--quick] [--only TOPIC ...] [--publish]`.

Prints a table per topic and keeps the numbers in benches/results/latest.json; `--only` leaves the
other topics' numbers as they are there. `--publish` makes docs/reference/benchmarks.* of them.
"""

import argparse
import json
import subprocess
import time
from pathlib import Path
from typing import Any

from rich.console import Console

from benches import page
from benches.machine import machine
from benches.options import Options
from benches.topics import TOPICS

FOLDER = Path(__file__).parent
LATEST = FOLDER / "results" / "latest.json"
WIDTH_OF_A_FILE = 220
BUILDS = (FOLDER / "c", FOLDER / "plat_baseline")


def run(options: Options, chosen: list[str], output: Path) -> dict[str, Any]:
    """Measures the chosen topics and writes the numbers after each."""
    for folder in BUILDS:
        subprocess.run(["make", "-s", "-C", folder], check=True)
    results: dict[str, Any] = {}
    if output.is_file() and chosen != list(TOPICS):
        results = json.loads(output.read_text(encoding="utf-8"))
    console = Console()
    if not console.is_terminal:
        console.width = max(console.width, WIDTH_OF_A_FILE)
    results |= {"quick": options.quick, "machine": machine()}
    for name in chosen:
        began, processor = time.perf_counter(), time.process_time()
        measured = TOPICS[name].measure(options)
        # What is printed is what will be read back.
        results[name] = json.loads(json.dumps(measured))
        took = {
            "wall_s": time.perf_counter() - began,
            "processor_s": time.process_time() - processor,
        }
        results.setdefault("took", {})[name] = took
        for table in TOPICS[name].tables(results[name]):
            console.print(table.rich())
        output.parent.mkdir(parents=True, exist_ok=True)
        output.write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    return results


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="tiny plant, one seed: for tests")
    parser.add_argument("--only", nargs="+", choices=list(TOPICS), default=list(TOPICS))
    parser.add_argument("--output", type=Path, default=LATEST)
    parser.add_argument("--publish", action="store_true", help="write docs/reference/benchmarks.*")
    asked = parser.parse_args()
    results = run(Options(asked.quick), asked.only, asked.output)
    if asked.publish:
        page.publish(results)


if __name__ == "__main__":
    main()
