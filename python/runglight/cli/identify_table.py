"""What was identified, as a table with sparklines, as CSV, and as JSON."""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np
from rich import box
from rich.table import Table
from rich.text import Text

from runglight.cli.counted import counted
from runglight.identification.verdict import verdict
from runglight.moments import iso

if TYPE_CHECKING:
    from rich.console import Console

    from runglight.identification.events import Events
    from runglight.identification.identify import Candidate, Identification
    from runglight.identification.sweep import Step, Sweep

CELLS = 48
"""Width of a sparkline: the recording from its start to its end."""
HEIGHTS = " ▁▂▃▄▅▆▇█"
WINDOW = "▔"
IN_WINDOW = "green"
OUTSIDE = "red"
COLUMNS = ("rank", "address", "name", "score_in", "score_out", "changes", "same_as", "agreement")


def print_found(console: Console, found: Identification, events: Events, rows: int) -> None:
    """The ranked table; a row above shows where the windows lie."""
    shown = found.best(rows)
    windows = _windows(found)
    table = Table(box=box.SIMPLE_HEAD, title=Text(_title(found, events)), title_justify="left")
    table.add_column("#", justify="right")
    table.add_column("Score in", justify="right")
    table.add_column("Score out", justify="right")
    agreed = any(each.agreement is not None for each in shown)
    if agreed:
        table.add_column("Agrees", justify="right")
    table.add_column("Address", overflow="fold")
    table.add_column("Name", overflow="fold")
    table.add_column("Changes", justify="right")
    table.add_column("Along the recording", no_wrap=True)
    ruler = Text("".join(WINDOW if inside else " " for inside in windows), style="blue")
    agrees = [""] * agreed
    table.add_row("", "", "", *agrees, "", Text("windows", style="dim"), "", ruler)
    for candidate, moments in zip(shown, found.moments(rows), strict=True):
        table.add_row(
            str(candidate.rank),
            f"{candidate.score_in:.4f}",
            f"{candidate.score_out:.4f}",
            *([_agreement(candidate)] if agreed else []),
            Text(candidate.address),
            _name(candidate),
            f"{candidate.changes:,}",
            _sparkline(found, moments, windows),
        )
    console.print(table)
    if len(found) > len(shown):
        console.print(
            f"{len(found) - len(shown):,} more: --rows {len(found)}, or --format csv",
            soft_wrap=True,
        )
    console.print(Text(verdict(found)), soft_wrap=True)


def print_agreement(console: Console, found: Identification, agreed: Identification) -> None:
    """Says so where changes matched with events one by one put another address first."""
    first, other = found.first(), agreed.first()
    if (
        not first
        or not other
        or {each.address for each in first} & {each.address for each in other}
    ):
        return
    console.print(
        Text(
            f"matched with the events one by one, {other[0].address} agrees best "
            f"({_agreement(other[0])} of 1): --order agreement lists them so"
        ),
        soft_wrap=True,
    )


def print_sweep(console: Console, sweep: Sweep) -> None:
    """What each τ gives, and which is suggested."""
    table = Table(box=box.SIMPLE_HEAD, title=Text("Several tau"), title_justify="left")
    for heading in ("Tau", "Windows"):
        table.add_column(heading, justify="right")
    for heading in ("Best", "Next"):
        table.add_column(heading, overflow="fold")
        table.add_column("Score in", justify="right")
        table.add_column("Score out", justify="right")
    table.add_column("Met", justify="right")
    table.add_column("Lead", justify="right")
    for at, step in enumerate(sweep.steps):
        table.add_row(*_step(step), style="bold" if at == sweep.suggested else "")
    console.print(table)
    console.print(Text(sweep.reason()), soft_wrap=True)


def _step(step: Step) -> list[Text | str]:
    cells: list[Text | str] = [f"{step.tau_s:g} s", f"{step.windows:,}"]
    for contender in (step.best, step.next):
        cells += (
            ["", "", ""]
            if contender is None
            else [
                Text(contender.address),
                f"{contender.score_in:.4f}",
                f"{contender.score_out:.4f}",
            ]
        )
    return [*cells, f"{step.met:.1f}", f"{step.lead:.1f}"]


def _title(found: Identification, events: Events) -> str:
    declared = counted(len(events) - len(found.unrecorded_ns), "event")
    return (
        f"{declared} in {counted(len(found.windows), 'window')} of ±{found.tau_s:g} s; "
        f"{found.changing:,} signals and bits change, the best {len(found):,}:"
    )


def _name(candidate: Candidate) -> Text:
    name = Text(candidate.name or "")
    if candidate.same_as != candidate.address:
        name.append(f"{' ' if candidate.name else ''}= {candidate.same_as}", style="dim")
    return name


def _agreement(candidate: Candidate) -> str:
    return "" if candidate.agreement is None else f"{candidate.agreement:.4f}"


def _windows(found: Identification) -> list[bool]:
    """Which cells of a sparkline a window reaches into."""
    inside = [False] * CELLS
    for window in found.windows:
        for cell in range(_cell(found, window.start_ns), _cell(found, window.end_ns) + 1):
            inside[cell] = True
    return inside


def _cell(found: Identification, time_ns: int) -> int:
    start, end = found.recorded_ns
    return min(CELLS - 1, (time_ns - start) * CELLS // max(1, end - start))


def _sparkline(found: Identification, moments: Any, windows: list[bool]) -> Text:
    """Changes per cell, the higher the more; red where no window is."""
    start, end = found.recorded_ns
    counts, _ = np.histogram(moments, bins=CELLS, range=(start, max(end, start + 1)))
    most = max(int(counts.max()), 1)
    line = Text()
    for count, inside in zip(counts.tolist(), windows, strict=True):
        height = 0 if count == 0 else max(1, round(count / most * (len(HEIGHTS) - 1)))
        line.append(HEIGHTS[height], style=IN_WINDOW if inside else OUTSIDE)
    return line


def as_csv(found: Identification) -> str:
    """All candidates."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for each in found:
        row = msgspec.structs.asdict(each)
        row |= {key: f"{row[key]:.4f}" for key in ("score_in", "score_out")}
        row["agreement"] = _agreement(each)
        writer.writerow(["" if row[column] is None else row[column] for column in COLUMNS])
    return text.getvalue()


def as_json(found: Identification, view: str, sweep: Sweep | None) -> str:
    """Everything: windows, areas, candidates, and the sweep where there was one."""
    start, end = found.recorded_ns
    told: dict[str, Any] = {
        "start": iso(start),
        "end": iso(end),
        "tau_s": found.tau_s,
        "view": view,
        "windows": [
            {"start": iso(each.start_ns), "end": iso(each.end_ns), "events": each.events}
            for each in found.windows
        ],
        "areas_s": found.areas_s,
        "unrecorded": [iso(time_ns) for time_ns in found.unrecorded_ns],
        "changing": found.changing,
        "candidates": list(found),
    }
    if sweep is not None:
        told["sweep"] = {"reason": sweep.reason(), "steps": sweep.steps}
    return msgspec.json.format(msgspec.json.encode(told), indent=2).decode() + "\n"
