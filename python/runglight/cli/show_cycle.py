"""`runglight show --cycle` and `--region`: what the cycle machine knows."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from runglight.cli import terminal
from runglight.cli.cycle_tables import print_cycle, print_machine
from runglight.cli.output import output as output_to
from runglight.drawing import draw_svg
from runglight.errors import InputError
from runglight.nearest import suggestion

if TYPE_CHECKING:
    from runglight.cycle_model import CycleModel
    from runglight.model import NominalModel

REGION_COLUMNS = (
    "region",
    "phase",
    "bits",
    "states",
    "initial",
    "final",
    "transitions",
    "either_order",
)
TRANSITION_COLUMNS = ("from", "to", "weight", "longest_stay_s")


def show_cycle(
    model: NominalModel,
    name: str,
    region: str | None,
    *,
    phase: str,
    chosen: str,
    output: Path | None,
) -> None:
    """Writes the regions, or one region's machine, in the format chosen."""
    cycle = model.cycle
    if cycle is None:
        raise InputError(
            f"{name}: the model has no cycle machine; name [modes] work_complete in runglight.toml "
            "and learn it again"
        )
    summary = cycle.summary()
    if region is not None:
        known = [entry["region"] for entry in summary["regions"]]
        if region not in known:
            near = suggestion(region, known)
            raise InputError(
                f"the model has no region {region!r}{near}; its regions: {', '.join(known)}"
            )
    elif chosen in {"dot", "svg"}:
        raise InputError(f"--format {chosen} draws one region: add --region")
    text = _text(cycle, summary, region, phase, chosen)
    with output_to(output) as stream:
        if text is not None:
            stream.write(text)
        elif region is None:
            print_cycle(terminal.console_for(stream), name, summary)
        else:
            print_machine(terminal.console_for(stream), cycle.machine(region, phase))


def _text(
    cycle: CycleModel, summary: dict[str, Any], region: str | None, phase: str, chosen: str
) -> str | None:
    if region is None:
        writers = {
            "json": lambda: json.dumps(summary, ensure_ascii=False, indent=2) + "\n",
            "csv": lambda: _csv(REGION_COLUMNS, region_rows(summary)),
        }
    else:
        machine = cycle.machine(region, phase)
        writers = {
            "json": lambda: json.dumps(machine, ensure_ascii=False, indent=2) + "\n",
            "csv": lambda: _csv(TRANSITION_COLUMNS, machine["transitions"]),
            "dot": lambda: cycle.dot(region, phase),
            "svg": lambda: draw_svg(cycle.dot(region, phase)),
        }
    return writers[chosen]() if chosen in writers else None


def region_rows(summary: dict[str, Any]) -> list[dict[str, Any]]:
    """One row per region and phase."""
    return [
        {
            "region": entry["region"],
            "phase": phase,
            "bits": " ".join(bit or "-" for bit in entry["bits"]),
            **entry[phase],
        }
        for entry in summary["regions"]
        for phase in ("work", "setup")
    ]


def _csv(columns: tuple[str, ...], rows: list[dict[str, Any]]) -> str:
    text = io.StringIO()
    writer = csv.DictWriter(text, columns, lineterminator="\n", extrasaction="ignore")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()
