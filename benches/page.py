"""docs/reference/benchmarks.md, from the JSON beside it: `python -m benches.page [--check]`."""

import argparse
import json
import sys
from pathlib import Path
from typing import Any

from benches import accuracy, clustering, throughput
from benches.page_text import HEAD, NOTES, findings_of
from benches.picture import draw
from benches.tables import Table, verdict
from benches.topics import TOPICS

REFERENCE = Path(__file__).parents[1] / "docs" / "reference"
NUMBERS = REFERENCE / "benchmarks.json"
PAGE = REFERENCE / "benchmarks.md"
PICTURE = REFERENCE / "operating-curve.svg"
SCORED = ("throughput", "accuracy")
"""Topics whose first table is what the page begins with."""


def publish(results: dict[str, Any]) -> None:
    """Writes numbers, picture and page."""
    NUMBERS.write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    if "budget" in results:
        draw(results["budget"]["curves"], PICTURE)
    PAGE.write_text(page(results), encoding="utf-8")


def page(results: dict[str, Any]) -> str:
    """The page."""
    text = HEAD + "## Met and missed\n\n" + _scoreboard(results).markdown()
    text += "\n## The machine\n\n" + _machine(results).markdown()
    for name, topic in TOPICS.items():
        if not results.get(name):
            continue
        title, sentences = NOTES[name]
        text += f"\n## {title}\n\n{sentences}\n"
        said = findings_of(name, results[name])
        if said:
            text += "\n" + "".join(f"- {sentence}\n" for sentence in said)
        for table in topic.tables(results[name])[name in SCORED :]:
            text += f"\n### {table.title}\n\n{table.markdown()}"
        if name == "budget":
            text += (
                f"\n![Injected faults found and false alarms, over the budget]({PICTURE.name})\n"
            )
    return text


def _scoreboard(results: dict[str, Any]) -> Table:
    """One row per demand, one column per plant."""
    plants = list(results.get("throughput") or results.get("accuracy") or {})
    cells: dict[tuple[str, str], dict[str, str]] = {}
    demanded = [
        *throughput.demanded(results.get("throughput", {})),
        *accuracy.figures(results.get("accuracy", {})),
        *clustering.figures(results.get("clustering", {})),
    ]
    for figure in demanded:
        row = figure["what"], figure["demand"]
        value = f"{figure['value']} {verdict(figure['met'])}"
        cells.setdefault(row, {})[figure["plant"]] = value
    rows = [
        [*row, *(of_plant.get(plant, "") for plant in plants)] for row, of_plant in cells.items()
    ]
    return Table("", ["figure", "demand", *plants], rows, left=2)


def _machine(results: dict[str, Any]) -> Table:
    about = results["machine"]
    took = sum(each["wall_s"] for each in results["took"].values())
    rows = [
        ["processor", f"{about['processor']}, {about['cores']} cores"],
        ["caches", f"level 2 {about['level 2 cache']}, level 3 {about['level 3 cache']}"],
        ["memory", f"{about['memory_gb']} GB"],
        ["system", f"{about['system']}, Linux {about['kernel']}"],
        [
            "versions",
            f"runglight {about['runglight']}, Python {about['python']}, numpy {about['numpy']}, "
            f"{about['compiler']}",
        ],
        ["load when the run began", ", ".join(f"{load:.2f}" for load in about["load"])],
        ["the run took", f"{took / 60:.1f} min"],
    ]
    return Table("", ["what", "value"], rows, left=2)


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument(
        "--check", action="store_true", help="fail where the page is not the JSON's"
    )
    asked = parser.parse_args()
    results = json.loads(NUMBERS.read_text(encoding="utf-8"))
    if not asked.check:
        publish(results)
    elif PAGE.read_text(encoding="utf-8") != page(results):
        sys.exit(f"{PAGE} is not what {NUMBERS.name} gives; run python -m benches.page")


if __name__ == "__main__":
    main()
