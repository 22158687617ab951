"""The cycle machine as tables: its regions, and the automaton of one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rich import box
from rich.table import Table
from rich.text import Text

from runglight.cli.counted import counted
from runglight.cli.model_tables import spoken_duration

if TYPE_CHECKING:
    from rich.console import Console

PHASES = {"work": "work", "setup": "set-up"}


def print_cycle(console: Console, name: str, summary: dict[str, Any]) -> None:
    """Regions, and how much was learned of each."""
    table = Table(box=box.SIMPLE_HEAD, title=Text(f"{name}: cycle machine"), title_justify="left")
    table.add_column("Region", no_wrap=True)
    table.add_column("Bits", overflow="fold")
    for phase in PHASES.values():
        table.add_column(f"States, {phase}", justify="right")
        table.add_column("Transitions", justify="right")
    for region in summary["regions"]:
        cells = [f"{region[phase][key]:,}" for phase in PHASES for key in ("states", "transitions")]
        table.add_row(Text(region["region"]), Text(bits_text(region["bits"])), *cells)
    console.print(table)
    phases = [
        f"{counted(summary['sequences'][phase], f'{spoken} sequence')} "
        f"({summary['left_out'][phase]:,} left out, longest "
        f"{spoken_duration(summary['longest_s'][phase])})"
        for phase, spoken in PHASES.items()
    ]
    console.print(
        Text(
            f"learned from {' and '.join(phases)} between edges of {summary['work_complete']}; "
            f"watched by {summary['mode']}"
        ),
        soft_wrap=True,
    )
    known = [stop for stop in summary["stops"] if stop["known"]]
    if known:
        console.print(Text(f"stops that are no failure: {'; '.join(map(_stop, known))}"))


def mode_bits_text(summary: dict[str, Any]) -> str:
    """Which bits say what the machine is about, and are no device of it."""
    bits: list[str] = summary["mode_bits"]
    are = "says" if len(bits) == 1 else "say"
    return (
        f"{', '.join(bits)} {are} what the machine is about: left out of the models of devices; "
        "what happens in manual or with an alarm is not learned"
    )


def print_machine(console: Console, machine: dict[str, Any]) -> None:
    """The transitions of one region, heaviest first in each state."""
    states = {state["word"]: state for state in machine["states"]}
    table = Table(
        box=box.SIMPLE_HEAD,
        title=Text(f"{machine['region']}, {PHASES[machine['phase']]}"),
        title_justify="left",
        caption=Text("▸ sequences begin here · ▪ sequences end here"),
        caption_justify="left",
    )
    table.add_column("State", no_wrap=True)
    table.add_column("Next", no_wrap=True)
    table.add_column("Weight", justify="right")
    table.add_column("Popularity", justify="right")
    left: dict[str, int] = {}
    for transition in machine["transitions"]:
        left[transition["from"]] = left.get(transition["from"], 0) + transition["weight"]
    shown: set[str] = set()
    for transition in machine["transitions"]:
        word = transition["from"]
        table.add_row(
            _state(states[word]) if word not in shown else "",
            transition["to"],
            f"{transition['weight']:,}",
            f"{transition['weight'] / left[word]:.2f}",
        )
        shown.add(word)
    for word, state in states.items():
        if word not in left:
            table.add_row(_state(state), "", "", "")
    console.print(table)


def bits_text(bits: list[str | None]) -> str:
    """`I8.7 … I8.0`; all of them where they are few."""
    named = [bit or "-" for bit in bits]
    return " ".join(named) if len(named) <= 4 else f"{named[0]} … {named[-1]} ({len(named)})"


def _stop(stop: dict[str, Any]) -> str:
    return f"{' and '.join(map(_sign, stop['signs']))} ({counted(stop['count'], 'time')})"


def _sign(sign: dict[str, Any]) -> str:
    name = sign["address"] or sign["signal"]
    value = "ON" if sign["value"] else "OFF"
    return f"{'' if sign['showed'] == 'came' else 'waits for '}{name} {value}"


def _state(state: dict[str, Any]) -> str:
    marks = ("▸" if state["initial"] else "") + ("▪" if state["final"] else "")
    return f"{state['word']} {marks}".rstrip()
