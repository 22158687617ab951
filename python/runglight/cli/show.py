"""`runglight show`: what a model knows."""

from __future__ import annotations

import csv
import io
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Parameter

from runglight.cli import terminal
from runglight.cli.exit_codes import DONE
from runglight.cli.model_tables import COLUMNS, print_rules, print_summary
from runglight.cli.output import output as output_to
from runglight.cli.show_cycle import show_cycle
from runglight.configuration import load_configuration
from runglight.drawing import draw_svg
from runglight.errors import InputError
from runglight.findings.finding import full_name
from runglight.model import NominalModel, load_model
from runglight.nearest import suggestion

Format = Literal["table", "csv", "dot", "svg", "json"]
Phase = Literal["work", "setup"]


@dataclass(frozen=True)
class Part:
    """One group, or one device of it."""

    group: str
    device: str | None = None

    @property
    def name(self) -> str:
        """`Group1`, or `Group1-PrtLDR`."""
        return full_name(self.group, self.device)


def show(
    model: Path,
    /,
    *,
    device: str | None = None,
    group: str | None = None,
    cycle: bool = False,
    region: str | None = None,
    phase: Phase = "work",
    format: Format | None = None,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
    config: Annotated[Path | None, Parameter(name=["--config", "-c"])] = None,
) -> int:
    """Show what a model knows: its devices, one device's rules, or a drawing.

    Without `--device` or `--group`: a table of groups and devices (csv: all rules).

    Parameters
    ----------
    model: Path
        Model directory written by `runglight learn`.
    device: str
        One device: `Group1-PrtLDR`, or `PrtLDR` where only one group has it.
    group: str
        One group: the chain of its devices' starting signals.
    cycle: bool
        The cycle machine: its regions, and how much was learned of each.
    region: str
        One region of the cycle machine: its states and transitions.
    phase: Literal["work", "setup"]
        Of a region: its sequences of work or of set-up.
    format: str
        Default: by the ending of the output file, else table.
    output: Path
        File to write instead of standard output.
    config: Path
        Configuration file (default: `runglight.toml`, if there is one).

    """
    chosen = format or _by_ending(output) or load_configuration(config).show.format or "table"
    nominal = load_model(model)
    if cycle or region is not None:
        if device is not None or group is not None:
            raise InputError(
                "--cycle and --region show the cycle machine; leave --device and --group out"
            )
        show_cycle(nominal, str(model), region, phase=phase, chosen=chosen, output=output)
        return DONE
    summary = nominal.summary()
    part = _part(summary, group, device)
    if chosen in {"dot", "svg"} and part is None:
        part = _only_group(summary, chosen)
    text = _text(chosen, nominal, summary, part, str(model))
    with output_to(output) as stream:
        if text is None:
            _print_table(terminal.console_for(stream), nominal, summary, part, str(model))
        else:
            stream.write(text)
    return DONE


def _text(
    chosen: str, model: NominalModel, summary: dict[str, Any], part: Part | None, name: str
) -> str | None:
    if chosen in {"dot", "svg"} and part is not None:
        dot = model.dot(part.group, part.device)
        return dot if chosen == "dot" else draw_svg(dot)
    if chosen == "csv":
        return rules_csv(_rows(model, part))
    if chosen == "json":
        shown = {"model": name, **summary, "transition_rules": _rows(model, part)}
        return json.dumps(shown, ensure_ascii=False, indent=2) + "\n"
    return None


def _print_table(
    console: Any, model: NominalModel, summary: dict[str, Any], part: Part | None, name: str
) -> None:
    if part is not None:
        print_rules(console, part.name, _rows(model, part))
        return
    print_summary(console, name, summary)
    first = next((d["device"] for g in summary["group_list"] for d in g["devices"]), None)
    if first is not None:
        console.print(
            f"One device: runglight show {name} --device {first}", markup=False, soft_wrap=True
        )


def rules_csv(rows: list[dict[str, Any]]) -> str:
    """The rules with the columns of `rules.parquet`."""
    text = io.StringIO()
    writer = csv.DictWriter(text, COLUMNS, lineterminator="\n", extrasaction="ignore")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def _rows(model: NominalModel, part: Part | None) -> list[dict[str, Any]]:
    text = model.rules_json() if part is None else model.rules_json(part.group, part.device)
    rows: list[dict[str, Any]] = json.loads(text)
    if part is not None and part.device is None:
        rows = [row for row in rows if row["device"] is None or row["model"] == "group"]
    return rows


def _part(summary: dict[str, Any], group: str | None, device: str | None) -> Part | None:
    groups = [entry["group"] for entry in summary["group_list"]]
    if group is not None and group not in groups:
        raise InputError(
            f"the model has no group {group!r}{suggestion(group, groups)}; "
            f"its groups: {_shortlist(groups)}"
        )
    if device is None:
        return None if group is None else Part(group)
    parts = [
        Part(entry["group"], known["device"])
        for entry in summary["group_list"]
        for known in entry["devices"]
        if group is None or entry["group"] == group
    ]
    matches = [part for part in parts if part.name == device] or [
        part for part in parts if part.device == device
    ]
    if not matches:
        # The short name is compared too, so that a slip in `PrtLDR` is found as well.
        short = {part.device or "": part.name for part in parts}
        near = suggestion(device, [part.name for part in parts]) or suggestion(device, short)
        raise InputError(
            f"the model has no device {device!r}{near}; "
            f"its devices: {_shortlist([part.name for part in parts])}"
        )
    if len(matches) > 1:
        names = " or ".join(part.name for part in matches)
        raise InputError(f"several groups have a device {device!r}; say which: {names}")
    return matches[0]


def _only_group(summary: dict[str, Any], chosen: str) -> Part:
    groups = [entry["group"] for entry in summary["group_list"]]
    if len(groups) != 1:
        raise InputError(
            f"--format {chosen} draws one device or group: add --device or --group; "
            f"its groups: {_shortlist(groups)}"
        )
    return Part(groups[0])


def _by_ending(output: Path | None) -> Format | None:
    endings: dict[str, Format] = {".csv": "csv", ".dot": "dot", ".gv": "dot", ".svg": "svg"}
    endings[".json"] = "json"
    return None if output is None else endings.get(output.suffix.lower())


def _shortlist(names: list[str]) -> str:
    return ", ".join(names[:12]) + (", …" if len(names) > 12 else "")
