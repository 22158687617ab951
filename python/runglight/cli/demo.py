"""`runglight demo`: learn a simulated cell, break it, name the fault."""

from __future__ import annotations

import asyncio
import json
import shutil
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich import box
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from runglight.cli import terminal
from runglight.cli.counted import counted
from runglight.cli.exit_codes import DONE
from runglight.cli.finding_table import (
    STYLES,
    expectation,
    look_first,
    newest_lines,
    print_findings,
    spoken_time,
    summary_line,
)
from runglight.cli.model_tables import print_rules, print_summary
from runglight.cli.output import output
from runglight.drawing import draw_svg, graphviz_program
from runglight.errors import InputError
from runglight.findings.finding import Finding, decode_finding
from runglight.findings.store import FindingStore
from runglight.findings.tally import Tally
from runglight.log.changelog import read_log
from runglight.model import NominalModel, learn
from runglight.recording.read import log_to_its_end

if TYPE_CHECKING:
    from rich.console import Console

    from runglight.plants import PlantDescription
    from runglight.plants.faults import FaultDescription

NOMINAL_CYCLES = 20
SHOWN_DEVICE = "PrtLDR"


def demo(
    *, fault: str = "1", to: Path = Path("demo-out"), page: bool | None = None, port: int = 8470
) -> int:
    """Break a machine and have the fault named.

    Serves a simulated assembly cell over Modbus TCP, records twenty cycles of it, learns them,
    breaks the cell, and says which device departed, at which address, what should have happened,
    and how the machine got there. Takes a minute or two. On a terminal it ends with the page open
    on the broken cell, which works on until Ctrl-C.

    Parameters
    ----------
    fault: str
        Which of the twelve faults, by number or name; `runglight simulate --list` names them.
    to: Path
        Directory for recordings, logs, model, drawings and findings (default: `demo-out`).
    page: bool
        Show the page at the end (default: where there is a terminal).
    port: int
        Port of the page (default: 8470; where that is taken, a free one).

    """
    # Plants need numpy: not before one is asked for.
    from runglight.plants import PLANTS, find_fault  # noqa: PLC0415

    cell = PLANTS["cell"]
    try:
        broken = find_fault(cell.faults, fault)
    except ValueError as error:
        raise InputError(f"--fault: {error}") from None
    to.mkdir(parents=True, exist_ok=True)
    for recording in (to / "nominal", to / "watched"):
        _away(recording)
    shows = terminal.is_attended() if page is None else page
    asyncio.run(_tell(terminal.results(), cell, broken, to, port if shows else None))
    return DONE


async def _tell(
    console: Console, cell: PlantDescription, broken: FaultDescription, to: Path, port: int | None
) -> None:
    from runglight.cli.demo_machine import demo_machine  # noqa: PLC0415

    async with demo_machine() as machine:
        _step(console, 1, f"Record {NOMINAL_CYCLES} cycles of a sound cell: {cell.description}")
        console.print(Text(f"   {machine.url}"), soft_wrap=True)
        with output(to / "symbols.csv") as stream:
            stream.write(machine.symbols)
        began_s = time.perf_counter()
        recorded_s = await machine.record(to / "nominal", NOMINAL_CYCLES)
        nominal = read_log(to / "nominal")
        nominal.write(to / "nominal.csv")
        console.print(
            f"   {counted(len(nominal), 'change')} in {recorded_s / 60:.0f} min of its time, "
            f"{time.perf_counter() - began_s:.0f} s of ours",
            highlight=False,
        )

        _step(console, 2, "Learn what nominal looks like")
        model = learn(nominal, symbols=to / "symbols.csv")
        model_directory = to / "cell.model"
        model.save(model_directory)
        summary = model.summary()
        print_summary(console, str(model_directory), summary)
        group = next(
            entry["group"]
            for entry in summary["group_list"]
            if any(device["device"] == SHOWN_DEVICE for device in entry["devices"])
        )
        rows = json.loads(model.rules_json(group, SHOWN_DEVICE))
        print_rules(console, f"The part loader, {group}-{SHOWN_DEVICE}", rows)
        drawings = _draw(console, model, summary, to)

        _step(console, 3, f"Watch it, and break it: fault {broken.number}, {broken.sentence}")

        def say(finding: Finding) -> None:
            style = STYLES.get(finding.severity, "")
            console.print(Text(f"   {finding.message}", style=style), soft_wrap=True)

        watched = await machine.watch_broken(
            str(broken.number), model, model_directory, to / "watched", say
        )
        if watched.latency_ms is not None:
            console.print(
                f"   told {watched.latency_ms:.0f} ms after the change in the PLC, "
                "polled every 10 ms",
                highlight=False,
            )

        log_to_its_end(to / "watched").write(to / "faulty.csv")
        with output(to / "findings.jsonl") as stream:
            stream.writelines(line + "\n" for line in watched.lines)
        findings = [decode_finding(line) for line in watched.lines]
        with FindingStore(model_directory) as store:
            ids = {finding.snapshot_id for finding in findings if finding.snapshot_id}
            texts = [text for each in ids if (text := store.snapshot(each)) is not None]
        snapshots = {snapshot["id"]: snapshot for snapshot in map(json.loads, texts)}
        _step(console, 4, "What it was")
        _name_the_fault(console, findings, snapshots)
        print_findings(console, findings, notices=False)
        line = summary_line(Tally.of(findings), watched.rows, watched.machine_s)
        console.print(Text(line), soft_wrap=True)
        _next(console, to, model_directory, drawings, findings)
        if port is not None:
            from runglight.cli.demo_page import show_page  # noqa: PLC0415

            await show_page(machine, to, port)


def _away(recording: Path) -> None:
    """Another demo's recording makes room for this one's; nothing else does."""
    if (recording / "recording.json").is_file():
        shutil.rmtree(recording)


def _name_the_fault(console: Console, findings: list[Finding], snapshots: dict[str, Any]) -> None:
    newest = newest_lines(findings)
    first = next((finding for finding in newest if finding.severity != "notice"), None)
    if first is None:
        console.print("Nothing departed from the model.")
        return
    incident = [finding for finding in newest if finding.incident == first.incident]
    facts = Table(box=None, show_header=False, pad_edge=False)
    facts.add_column(style="bold", no_wrap=True)
    facts.add_column(overflow="fold")
    facts.add_row("What", Text(first.message))
    facts.add_row("When", Text(f"{spoken_time(first.time)} UTC"))
    facts.add_row("Where", Text(first.place))
    facts.add_row("Look first at", Text(look_first(incident)))
    if expected := expectation(first):
        facts.add_row("Expected", Text(expected))
    if first.path:
        facts.add_row("How it got there", Text(" → ".join(_short(first, first.path))))
    elif first.from_state:
        states = [state for state in (first.from_state, first.to_state) if state]
        facts.add_row("How it got there", Text(" → ".join(_short(first, states))))
    others = snapshots.get(first.snapshot_id or "", {}).get("devices", {})
    if others:
        # The snapshot: where every device stood at the first sign.
        facts.add_row("Devices then", Text(", ".join(each["state"] for each in others.values())))
    title = Text(f"{first.severity}: {first.kind.replace('_', ' ')}".upper())
    style = STYLES.get(first.severity, "")
    console.print(Panel(facts, title=title, border_style=style, box=box.ROUNDED, padding=(1, 2)))


def _short(finding: Finding, states: list[str]) -> list[str]:
    return [state.removeprefix(f"{finding.place}-") for state in states]


def _draw(console: Console, model: NominalModel, summary: dict[str, object], to: Path) -> list[str]:
    drawn: list[str] = []
    can_draw = graphviz_program() is not None
    for group, device in _parts(summary):
        name = group if device is None else f"{group}-{device}"
        dot = model.dot(group, device)
        with output(to / f"{name}.dot") as stream:
            stream.write(dot)
        if can_draw:
            with terminal.working(f"Drawing {name}"), output(to / f"{name}.svg") as stream:
                stream.write(draw_svg(dot))
        drawn.append(f"{name}.{'svg' if can_draw else 'dot'}")
    if not can_draw:
        terminal.note(
            "no Graphviz here, so the drawings are .dot files: apt install graphviz, "
            'or pip install "runglight[svg]"'
        )
    return drawn


def _parts(summary: dict[str, object]) -> list[tuple[str, str | None]]:
    parts: list[tuple[str, str | None]] = []
    groups = summary["group_list"]
    assert isinstance(groups, list)
    for entry in groups:
        parts.append((entry["group"], None))
        parts.extend((entry["group"], device["device"]) for device in entry["devices"])
    return parts


def _step(console: Console, number: int, sentence: str) -> None:
    console.print()
    console.print(Text.assemble((f"{number}  ", "bold cyan"), (sentence, "bold")))


def _next(
    console: Console, to: Path, model: Path, drawings: list[str], findings: list[Finding]
) -> None:
    console.print()
    console.print(
        Text(f"Written to {to}: logs, symbol table, model, findings and {len(drawings)} drawings.")
    )
    console.print(Text("Next:", "bold"))
    commands = [
        f"runglight show {model} --device {SHOWN_DEVICE}",
        f"runglight watch {model} {to / 'watched'} --format jsonl",
        f"runglight demo --fault 5 --to {to}",
    ]
    confirmable = [finding.id for finding in findings if finding.path and finding.kind != "stall"]
    if confirmable:
        commands.append(f"runglight confirm {model} {confirmable[-1]}")
    for command in commands:
        console.print(Text(f"  {command}"), soft_wrap=True)
