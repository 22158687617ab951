"""Models as tables: what was learned, and the transition rules as in Ghosh 2016, Table 2."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rich import box
from rich.table import Table
from rich.text import Text

from runglight.cli.counted import counted
from runglight.findings.finding import full_name

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rich.console import Console

COLUMNS = (
    "model",
    "group",
    "device",
    "current",
    "next",
    "count",
    "transition_probability",
    "cluster",
    "average_s",
    "minimum_s",
    "maximum_s",
    "time_probability",
    "position",
    "trigger",
    "trigger_average_s",
    "trigger_maximum_s",
)
"""Columns shown of `rules.parquet`, in order."""


def print_summary(console: Console, name: str, summary: dict[str, Any]) -> None:
    """Groups and devices, and what the model was learned from."""
    groups = summary["group_list"]
    table = Table(box=box.SIMPLE_HEAD, title=Text(f"{name}: nominal model"), title_justify="left")
    table.add_column("Group")
    table.add_column("Device")
    table.add_column("Starts with")
    table.add_column("Signals", justify="right")
    table.add_column("Rules", justify="right")
    for group in groups:
        for position, device in enumerate(group["devices"]):
            table.add_row(
                Text(group["group"] if position == 0 else ""),
                Text(device["device"]),
                Text(device["start"] or "-"),
                f"{device['signals']:,}",
                f"{device['rules']:,}",
            )
    console.print(table)
    scan = summary.get("scan_interval_s")
    console.print(
        Text(
            f"{counted(summary['devices'], 'device')} in {counted(summary['groups'], 'group')}, "
            f"{counted(summary['signals'], 'signal')}, {counted(summary['rules'], 'rule')}; "
            f"learned from {counted(summary['events'], 'event')} in "
            f"{spoken_duration(summary['duration_s'])} (timing {summary['timing']}"
            + (f", scan interval {scan * 1000:g} ms" if scan else "")
            + ")"
        ),
        soft_wrap=True,
    )


def print_rules(console: Console, title: str, rows: Sequence[dict[str, Any]]) -> None:
    """One row per transition and time cluster."""
    table = Table(
        box=box.SIMPLE_HEAD,
        title=Text(title),
        title_justify="left",
        caption=Text(
            "TP probability of the transition · ATT average, min and max time in seconds · "
            "TTP probability of that time · Waits for: the event that enables the transition, "
            "and the average time since then"
        ),
        caption_justify="left",
    )
    table.add_column("Current", overflow="fold")
    table.add_column("Next", overflow="fold")
    for heading in ("Count", "TP", "ATT", "Min", "Max", "TTP"):
        table.add_column(heading, justify="right", no_wrap=True)
    if any(row["trigger"] for row in rows):
        table.add_column("Waits for", overflow="fold")
    previous: tuple[str, str] | None = None
    for row in rows:
        transition = (row["current"], row["next"])
        first = transition != previous
        previous = transition
        prefix = full_name(row["group"], row["device"]) + "-"
        table.add_row(
            Text(row["current"].removeprefix(prefix) if first else ""),
            Text(row["next"].removeprefix(prefix) if first else ""),
            f"{row['count']:,}" if first else "",
            f"{row['transition_probability']:.2f}" if first else "",
            _seconds(row["average_s"]),
            _seconds(row["minimum_s"]),
            _seconds(row["maximum_s"]),
            f"{row['time_probability']:.2f}" if row["time_probability"] is not None else "",
            *([_waits_for(row)] if row["trigger"] and first else []),
        )
    console.print(table)


def _waits_for(row: dict[str, Any]) -> Text:
    """`DCHA-ADV_ON + 0.02`, the later of two where it waits for both."""
    states = row["trigger"].replace(f"{row['group']}-", "")
    return Text(f"{states} + {row['trigger_average_s']:.2f}")


def spoken_duration(seconds: float) -> str:
    """`45 s`, `12 min`, `3.5 h`, `2.1 days`."""
    if seconds < 120:
        return f"{seconds:.3g} s"
    if seconds < 7200:
        return f"{seconds / 60:.0f} min"
    if seconds < 172_800:
        return f"{seconds / 3600:.1f} h"
    return f"{seconds / 86400:.1f} days"


def _seconds(value: float | None) -> str:
    return "" if value is None else f"{value:.2f}"
