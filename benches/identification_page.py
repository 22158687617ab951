"""docs/reference/identification.*, from what `benches.identification` has measured."""

import json
from pathlib import Path
from typing import Any

from benches.identification_text import HEAD, TAIL, TITLES
from benches.tables import Table, share, verdict

REFERENCE = Path(__file__).parents[1] / "docs" / "reference"
FLOORS = {"study": 0.95, "proposed": 0.90}
ORDERS = {"scores": "by score in, then score out", "agreement": "by agreement one by one"}
SEEDS_WANTED = 50
"""Of the proposed events: fewer decide nothing."""
_AXES = {
    "missed": "share of events missed",
    "offset_s": "events declared late by, s",
    "length_minutes": "recording, minutes",
}


def tables(result: dict[str, Any]) -> list[Table]:
    """All tables of the page."""
    return [_studies(result), *(_falls(result, axis) for axis in _AXES)]


def publish(folder: Path) -> None:
    """Writes numbers, picture and page."""
    result = json.loads((folder / "study.json").read_text(encoding="utf-8"))
    result["proposed"] = json.loads((folder / "proposed.json").read_text(encoding="utf-8"))
    numbers = REFERENCE / "identification.json"
    numbers.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    draw(result, REFERENCE / "identification.svg")
    (REFERENCE / "identification.md").write_text(page(result), encoding="utf-8")


def page(result: dict[str, Any]) -> str:
    """The page."""
    text = HEAD
    for table in (_studies(result), _mistaken(result), _proposals(result)):
        text += f"\n## {table.title}\n\n{TITLES[table.title]}\n\n{table.markdown()}"
    text += "\n## How it falls\n\n![Share ranked first](identification.svg)\n"
    for axis in _AXES:
        table = _falls(result, axis)
        text += f"\n### {table.title}\n\n{table.markdown()}"
    return text + TAIL


def _studies(result: dict[str, Any]) -> Table:
    rows = []
    for name, case in result["cases"].items():
        for order, words in ORDERS.items():
            study, of = case["study"][order], case["study"]["seeds"]
            met = study["first"] >= FLOORS["study"] * of
            rows.append(
                (
                    f"{name}, τ = {case['tau_s']:g} s, {words}",
                    f"{study['first']} of {of}",
                    share(study["first"], of),
                    share(study["in_first_five"], of),
                    share(study["selected"], of),
                    verdict(met),
                )
            )
    columns = ("Case", "Ranked first", "", "In the first five", "Selected", "Floor 95 %")
    return Table("The two case studies", columns, rows)


def _mistaken(result: dict[str, Any]) -> Table:
    rows = []
    for name, case in result["cases"].items():
        for order, words in ORDERS.items():
            wrong = sorted(case["study"][order]["wrong"].items(), key=lambda item: -item[1])
            told = ", ".join(f"`{address}` {count}x" for address, count in wrong[:8])
            rows.append((f"{name}, {words}", told or "none"))
    return Table("What is ranked first where it is wrong", ("Case", "Addresses"), rows, left=2)


def _proposals(result: dict[str, Any]) -> Table:
    rows = []
    for name in result["cases"]:
        trials = [each for each in result["proposed"] if each["case"] == name]
        for order, words in ORDERS.items():
            first = sum(each[order]["first"] for each in trials)
            off = sum(abs(each["proposed"] - each["seen"]) for each in trials)
            rows.append(
                (
                    f"{name}, {words}",
                    f"{first} of {len(trials)}",
                    share(first, len(trials)),
                    share(off, sum(each["seen"] for each in trials)),
                    verdict(first >= FLOORS["proposed"] * len(trials))
                    if len(trials) >= SEEDS_WANTED
                    else f"open: {len(trials)} of {SEEDS_WANTED} seeds measured",
                )
            )
    columns = ("Case", "Ranked first", "", "Events too many or too few", "Floor 90 %")
    return Table("Events from the photos alone", columns, rows)


def _falls(result: dict[str, Any], axis: str) -> Table:
    names = list(result["cases"])
    values = list(result["cases"][names[0]][axis])
    rows = []
    for value in values:
        cells = [value, str(result["cases"][names[0]][axis][value]["seeds"])]
        for name in names:
            point = result["cases"][name][axis][value]
            cells += [share(point[order]["first"], point["seeds"]) for order in ORDERS]
        rows.append(cells)
    heads = [f"{name}, {words}" for name in names for words in ORDERS.values()]
    return Table(f"Ranked first, by {_AXES[axis]}", (_AXES[axis], "Recordings", *heads), rows)


def draw(result: dict[str, Any], path: Path) -> None:
    """Three curves of the share ranked first; needs matplotlib (extra `bench`)."""
    import matplotlib as mpl  # noqa: PLC0415

    mpl.use("Agg")
    mpl.rcParams.update({"svg.hashsalt": "runglight", "svg.fonttype": "none", "font.size": 9})
    import matplotlib.pyplot as plt  # noqa: PLC0415

    figure, panels = plt.subplots(1, 3, figsize=(12, 3.6), layout="constrained", sharey=True)
    for panel, (axis, label) in zip(panels, _AXES.items(), strict=True):
        for number, (name, case) in enumerate(result["cases"].items()):
            for order, words in ORDERS.items():
                points = case[axis]
                found = [100 * each[order]["first"] / each["seeds"] for each in points.values()]
                panel.plot(
                    [float(value) for value in points],
                    found,
                    color=f"C{number}",
                    linestyle=":" if order == "scores" else "-",
                    marker="o",
                    markersize=3,
                    label=f"{name}, {words}",
                )
        panel.set(xlabel=label, ylim=(0, 103))
        panel.grid(alpha=0.3)
    panels[0].set_ylabel("right address ranked first, %")
    panels[0].legend(fontsize=7, loc="lower left")
    figure.savefig(path, metadata={"Date": None, "Creator": "benches/identification_page.py"})
    plt.close(figure)
