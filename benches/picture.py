"""The operating curve as a picture; the only place that needs matplotlib (extra `bench`)."""

from pathlib import Path
from typing import Any


def draw(curves: dict[str, Any], path: Path) -> None:
    """Faults found, and false alarms a day, over the budget."""
    import matplotlib as mpl  # noqa: PLC0415

    mpl.use("Agg")
    mpl.rcParams.update({"svg.hashsalt": "runglight", "svg.fonttype": "none", "font.size": 9})
    import matplotlib.pyplot as plt  # noqa: PLC0415

    figure, (found, false) = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
    for name, points in curves.items():
        budgets = [point["budget"] for point in points]
        of_all = [100 * point["alarms"] / max(point["injected"], 1) for point in points]
        said = [100 * point["any"] / max(point["injected"], 1) for point in points]
        (line,) = found.plot(budgets, of_all, marker="o", markersize=3, label=name)
        found.plot(budgets, said, linestyle=":", color=line.get_color())
        rates = [point["false_alarms"] / point["days"] for point in points]
        false.plot(budgets, rates, marker="o", markersize=3, color=line.get_color(), label=name)
    budgets = [point["budget"] for point in next(iter(curves.values()))]
    false.plot(budgets, budgets, color="grey", linewidth=0.8, linestyle="--", label="the budget")
    found.set(xscale="log", xlabel="false alarms allowed a day", ylim=(0, 102))
    found.set_title("Injected faults found, %: by alarms (dotted: by anything)")
    false.set(xscale="log", xlabel="false alarms allowed a day")
    false.set_yscale("symlog", linthresh=0.01)
    false.set_ylim(bottom=0)
    false.set_title("False alarms a day on the nominal part")
    for axes in (found, false):
        axes.grid(alpha=0.3)
    false.legend(fontsize=7)
    figure.savefig(path, metadata={"Date": None, "Creator": "benches/picture.py"})
    plt.close(figure)
