"""Where the command line prints: results on standard output, the rest on standard error."""

from __future__ import annotations

import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING, TextIO

from runglight import environment

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    # rich is loaded where something is drawn: a program that reads JSON lines need not wait for it.
    from rich.console import Console
    from rich.status import Status

WIDTH_WITHOUT_TERMINAL = 140


def console_for(stream: TextIO) -> Console:
    """A console on a stream; wide where no terminal sets the width."""
    from rich.console import Console  # noqa: PLC0415

    width = None if stream.isatty() else environment.columns(WIDTH_WITHOUT_TERMINAL)
    return Console(file=stream, width=width, highlight=False, soft_wrap=False)


def results() -> Console:
    """Standard output, for what the user asked for."""
    return console_for(sys.stdout)


def note(sentence: str) -> None:
    """Says something beside the result, on standard error."""
    print(f"note: {' '.join(sentence.split())}", file=sys.stderr)


@contextmanager
def working(doing: str) -> Iterator[None]:
    """A spinner while something of unknown length runs; silent where no terminal is."""
    if not _watched():
        yield
        return
    from rich.console import Console  # noqa: PLC0415

    with Console(file=sys.stderr).status(doing):
        yield


@contextmanager
def progressing(doing: str, total: int) -> Iterator[Callable[[int], None]]:
    """A bar that the given function advances; silent where no terminal is."""
    if not _watched():
        yield lambda _done: None
        return
    from rich.console import Console  # noqa: PLC0415
    from rich.progress import Progress  # noqa: PLC0415

    with Progress(console=Console(file=sys.stderr), transient=True) as progress:
        task = progress.add_task(doing, total=total)
        yield lambda done: progress.advance(task, done)


class Report:
    """A line at the foot of the terminal, written anew and anew; nothing where no terminal is."""

    def __init__(self, status: Status | None) -> None:
        self._status = status

    def show(self, line: str) -> None:
        """From now on the line reads so."""
        if self._status is not None:
            from rich.text import Text  # noqa: PLC0415

            self._status.update(Text(line))

    @contextmanager
    def paused(self) -> Iterator[None]:
        """Takes the line away while something is printed."""
        if self._status is not None:
            self._status.stop()
        yield
        if self._status is not None:
            self._status.start()


@contextmanager
def reporting() -> Iterator[Report]:
    """A line that says how a long job stands."""
    if not _watched():
        yield Report(None)
        return
    from rich.console import Console  # noqa: PLC0415

    with Console(file=sys.stderr).status("") as status:
        yield Report(status)


def is_attended() -> bool:
    """Whether somebody sits at a terminal, and could press Ctrl-C."""
    return sys.stdin.isatty() and sys.stdout.isatty() and not environment.unattended()


def _watched() -> bool:
    return sys.stderr.isatty() and not environment.unattended()
