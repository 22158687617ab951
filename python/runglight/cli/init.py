"""`runglight init`: a commented `runglight.toml` for a machine."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter
from rich.text import Text

from runglight.cli import terminal
from runglight.cli.check import ask
from runglight.cli.counted import counted
from runglight.cli.exit_codes import DONE
from runglight.configuration import DEFAULT_FILE, DEFAULT_NAMING
from runglight.errors import InputError
from runglight.replacing import replacing
from runglight.taps import is_live

if TYPE_CHECKING:
    from collections.abc import Sequence

    from runglight.taps.base import Answer

SYMBOLS = "symbols.csv"


def init(
    url: str,
    /,
    *,
    config: Annotated[Path, Parameter(name=["--config", "-c"])] = DEFAULT_FILE,
) -> int:
    """Write a commented configuration for a machine, and a symbol table to fill in.

    Asks the machine which signals it has; nothing is written to the PLC. Files that exist are
    left alone: the configuration is refused, the symbol table is used as it is.

    Parameters
    ----------
    url: str
        Live address: `modbus://plc?inputs=0-63&coils=0-31`.
    config: Path
        File to write (default: `runglight.toml`).

    """
    if config.exists():
        raise InputError(f"{config}: is there already; name another file with -c, or remove it")
    if not is_live(url):
        raise InputError(f"{url}: is no live address; write it like modbus://plc?inputs=0-63")
    asked = ask(url)
    silent = [answer for answer in asked.answers if answer.error is not None]
    symbols = config.parent / SYMBOLS
    _write(config, configuration_text(url, asked.answers))
    console = terminal.results()
    signals = counted(len(asked.answers), "signal")
    console.print(Text(f"{config}: written; {asked.url} has {signals}"), soft_wrap=True)
    if symbols.exists():
        console.print(Text(f"{symbols}: is there already and left as it is"), soft_wrap=True)
    else:
        _write(symbols, symbols_text(asked.answers))
        console.print(Text(f"{symbols}: fill in group, device and signal"), soft_wrap=True)
    if silent:
        terminal.note(
            f"{counted(len(silent), 'signal')} did not answer; "
            f"runglight check -c {config} says which"
        )
    return DONE


def configuration_text(url: str, answers: Sequence[Answer]) -> str:
    """The file: what is known is set, what may be wanted stands in comments."""
    classes = ("input", "output", "memory")
    counts = {each: sum(a.signal.signal_class == each for a in answers) for each in classes}
    has = ", ".join(f"{number} {name}" for name, number in counts.items() if number)
    return f"""\
# This machine in one file. Keys in comments show their defaults, or an example.
# All keys: docs/reference/configuration.md

[source]
# Found there: {has or "no signals yet"}.
url = {json.dumps(url)}
# Time between two scans, where the source is polled.
# interval = "10ms"

[symbols]
# What the addresses are called; fill in group, device and signal.
table = "{SYMBOLS}"
# naming = "{DEFAULT_NAMING}"

[record]
# runglight record
# to = "recording"

[signal_state]
# runglight learn: the budget of false alarms, and when a silent group has stalled.
# false_alarms_per_day = 1.0
# stall_after_s = 180.0

[modes]
# Which bits say what the machine is about: with work_complete the cycle machine is learned too,
# which names the failing address. "M0.2=0" is a bit that says it when OFF.
# work_complete = "M0.0"
# manual = "M0.1"
# alarm = "M0.2"

[regions]
# Parts of the machine that go their own ways; without any, runglight learn proposes some.
# actuators = "I8-I20 by byte"

[cycle]
# A stop with the alarm ON that was learned so often is no failure; 0: every one is.
# known_stops = 3

[watch]
# runglight watch MODEL
# format = "table"
# state = "watch.state"
# record = "recording"
# store = "postgresql://user@host/database"

[notify]
# publish = "mqtt://broker/plant/cell"
# webhook = "https://host/path"

[server]
# metrics = "127.0.0.1:9109"
"""


def symbols_text(answers: Sequence[Answer]) -> str:
    """A symbol table with all that the source itself knows."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(("address", "group", "device", "signal", "class", "type", "description"))
    for answer in answers:
        each = answer.signal
        table.writerow((each.address, "", "", "", each.signal_class, each.type, each.description))
    return text.getvalue()


def _write(path: Path, text: str) -> None:
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
