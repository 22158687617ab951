"""Findings on the screen the moment they are made, and a line that says how watching goes."""

from __future__ import annotations

import datetime
import sys
from typing import TYPE_CHECKING, Protocol, TextIO

from rich.text import Text

from runglight.cli import terminal
from runglight.cli.counted import counted
from runglight.cli.finding_table import (
    STYLES,
    expectation,
    look_first,
    spoken_time,
    suspects_text,
)
from runglight.findings import flat
from runglight.findings.finding import decode_finding

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from runglight.findings.finding import Finding
    from runglight.live.status import Status

CLEAR_LINE = "\r\x1b[2K"
INCIDENTS_REMEMBERED = 1_000


class LiveFormat(Protocol):
    """One way to write findings as they come."""

    def begin(self) -> None:
        """Before the first finding."""

    def tell(self, lines: Sequence[str]) -> None:
        """Writes findings; they are out when this returns."""


class JsonLines:
    """One JSON object per line, for programs."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def begin(self) -> None:
        """Nothing stands above the lines."""

    def tell(self, lines: Sequence[str]) -> None:
        """Writes and flushes each line."""
        for line in lines:
            self._stream.write(line + "\n")
            self._stream.flush()


class CsvLines:
    """The keys of the schema as columns, for spreadsheets."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def begin(self) -> None:
        """The names of the columns."""
        self._stream.write(flat.header())
        self._stream.flush()

    def tell(self, lines: Sequence[str]) -> None:
        """Writes and flushes each line."""
        for line in lines:
            self._stream.write(flat.row(line))
            self._stream.flush()


class People:
    """For whoever is called at three in the morning: when, how grave, where, what, and what next.

    What follows from an earlier finding is indented; a finding that ends says so in one line.
    """

    def __init__(self, stream: TextIO, *, notices: bool) -> None:
        self._stream = stream
        self._console = terminal.console_for(stream)
        self._notices = notices
        self._incidents: dict[str, None] = {}
        self._shown: dict[str, None] = {}

    def begin(self) -> None:
        """Nothing stands above the findings."""

    def tell(self, lines: Sequence[str]) -> None:
        """Prints findings; notices only where the user wants them or they explain an alarm."""
        for line in lines:
            finding = decode_finding(line)
            follows = finding.incident in self._incidents
            wanted = self._notices or follows or finding.kind == "gap"
            if finding.severity == "notice" and not wanted:
                continue
            _remember(self._incidents, finding.incident)
            if finding.id in self._shown:
                self._print(self._change(finding))
            else:
                _remember(self._shown, finding.id)
                self._print(self._whole(finding, follows=follows))
        self._stream.flush()

    def _print(self, text: Text) -> None:
        self._console.print(text, soft_wrap=True)

    def _whole(self, finding: Finding, *, follows: bool) -> Text:
        style = STYLES.get(finding.severity, "")
        indent = " " * 25
        text = Text(f"{spoken_time(finding.time)}  ")
        text.append(f"{finding.severity.upper():<8}", style)
        text.append("└ " if follows else "")
        text.append(_class(finding))
        if finding.place and finding.place not in finding.message:
            text.append(f"{finding.place}  ", "bold")
        text.append(finding.message)
        if expected := expectation(finding):
            text.append(f"\n{indent}Expected: {expected}", "dim")
        if suspects := suspects_text(finding):
            text.append(f"\n{indent}Suspects: {suspects}", "dim")
        if not follows and finding.severity != "notice":
            text.append(f"\n{indent}→ Look first at {look_first([finding])}.", "bold")
        if finding.severity != "notice":
            text.append(f"\n{indent}id {finding.id}", "dim")
        return text

    def _change(self, finding: Finding) -> Text:
        text = Text(f"{spoken_time(finding.time)}  ")
        text.append(f"{finding.state:<8} ", "green" if finding.state == "returned" else "bold")
        text.append(_class(finding))
        text.append(finding.message)
        text.append(f"  id {finding.id}", "dim")
        return text


def _class(finding: Finding) -> str:
    return "" if finding.rank is None else f"class {finding.rank}  "


class StatusLine:
    """The last line of a terminal: connection, scans, last change, what is open."""

    def __init__(self, stream: TextIO, now_s: Callable[[], float]) -> None:
        self._stream = stream
        self._now_s = now_s
        self._on = stream.isatty()
        self._drawn = False

    def draw(self, status: Status) -> None:
        """Draws over the line that stands there."""
        if not self._on:
            return
        width = terminal.console_for(self._stream).width
        self._stream.write(CLEAR_LINE + status_text(status, self._now_s())[: width - 1])
        self._stream.flush()
        self._drawn = True

    def clear(self) -> None:
        """Makes room for what is printed next."""
        if self._drawn:
            self._stream.write(CLEAR_LINE)
            self._stream.flush()
            self._drawn = False


def status_text(status: Status, now_s: float) -> str:
    """`connected · 99.8 scans/s · last change 0.2 s ago · 2 open findings`."""
    parts = [status.state]
    if status.state != "connected" and status.reason:
        parts[0] += f" ({status.reason})"
    if status.scans_per_s:
        parts.append(f"{status.scans_per_s:,.1f} scans/s")
    if status.last_change is not None:
        parts.append(f"last change {_ago(now_s - _seconds(status.last_change))}")
    parts.append(f"{counted(status.open, 'open finding')}" if status.open else "nothing open")
    if status.reconnects:
        parts.append(counted(status.reconnects, "reconnect"))
    return " · ".join(parts)


def live_format(name: str, stream: TextIO | None, *, notices: bool) -> LiveFormat:
    """The way to write findings that the user chose."""
    stream = stream or sys.stdout
    if name == "jsonl":
        return JsonLines(stream)
    if name == "csv":
        return CsvLines(stream)
    return People(stream, notices=notices)


def _seconds(moment: str) -> float:
    return datetime.datetime.fromisoformat(moment).timestamp()


def _ago(seconds: float) -> str:
    seconds = max(seconds, 0.0)
    if seconds < 120:
        return f"{seconds:.1f} s ago"
    return f"{seconds / 60:.0f} min ago" if seconds < 7200 else f"{seconds / 3600:.0f} h ago"


def _remember(remembered: dict[str, None], key: str) -> None:
    remembered.pop(key, None)
    remembered[key] = None
    if len(remembered) > INCIDENTS_REMEMBERED:
        del remembered[next(iter(remembered))]
