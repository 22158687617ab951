"""`runglight identify --propose`: events from the photos of a recording."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from rich.text import Text

from runglight.cli import terminal
from runglight.cli.counted import counted
from runglight.cli.exit_codes import DONE
from runglight.errors import InputError
from runglight.identification.proposal import By, propose_events
from runglight.identification.rectangle import Rectangle
from runglight.recording.layout import EVENTS
from runglight.recording.photos import photos

if TYPE_CHECKING:
    from pathlib import Path


def propose_to(recording: Path, written: str, by: By, output: Path | None) -> int:
    """Writes them to a file that is not there yet, and says what to do with it."""
    rectangle = Rectangle.parse(written)
    target = output or recording / EVENTS
    if target.exists():
        raise InputError(
            f"{target}: is there already, and may hold what you declared; "
            "name another file with -o, or move it away"
        )
    with terminal.progressing("Looking at photos", 2 * len(photos(recording))) as advance:
        events = propose_events(recording, rectangle, by=by, advance=advance)
    if not len(events):
        other = "motion" if by == "look" else "look"
        raise InputError(
            f"{recording}: nothing changes in the rectangle {written} by {by}; "
            f"take another one, or --propose-by {other}"
        )
    events.write(target)
    kinds = Counter(events.labels)
    shown = ", ".join(f"{number} {label}" for label, number in kinds.items())
    console = terminal.results()
    console.print(Text(f"{target}: {counted(len(events), 'event')} ({shown})"), soft_wrap=True)
    option = "" if output is None else f" --events {target}"
    choice = f" --label {next(iter(kinds))}" if len(kinds) > 1 else ""
    console.print(
        Text(
            f"Correct it where it is wrong, then: runglight identify {recording}{option}{choice}"
            + (" (or --label any)" if choice else "")
        ),
        soft_wrap=True,
    )
    return DONE
