"""`runglight import --sql … --to DIR`: what is new in a table, once or again and again."""

from __future__ import annotations

import signal
import threading
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from runglight.cli import terminal
from runglight.cli.exit_codes import DONE
from runglight.errors import InputError
from runglight.log.symbols import names_by_address, read_symbols, renamed

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from runglight.cli.reader_options import ReaderOptions
    from runglight.log.changelog import Log
    from runglight.log.imported import ImportDirectory
    from runglight.log.options import ReadOptions


def is_directory(to: Path) -> bool:
    """True where a target is meant as a directory: it is one, or its name has no ending."""
    return to.is_dir() or (not to.suffix and not to.exists())


def import_to_directory(to: Path, options: ReaderOptions, every_s: float | None) -> int:
    """Takes what is new; with a time between, until the user or the system ends it."""
    try:
        from runglight.log.database.connection import DatabaseUnavailableError  # noqa: PLC0415
        from runglight.log.database.incremental import directory_for, import_new  # noqa: PLC0415
    except ModuleNotFoundError as missing:
        if missing.name != "sqlalchemy":
            raise
        raise InputError(
            'reading from a database needs SQLAlchemy: pip install "runglight[sql]"'
        ) from None
    configuration = options.configuration()
    options.sources([], configuration.log, "what shall be read?")
    renaming: Callable[[Log], Log] | None = None
    if configuration.symbols.table is not None:
        table = read_symbols(Path(configuration.symbols.table))
        names = names_by_address(table, configuration.symbols.naming)

        def renaming(log: Log) -> Log:
            return renamed(log, names)

    with directory_for(configuration.log, to) as directory, _ending() as ended:
        waiting = every_s is not None
        take = _Taking(configuration.log, directory, renaming, ended, import_new)
        take.all_that_is_new(say_nothing_new=True)
        unavailable = False
        while waiting and not ended.wait(every_s):
            try:
                take.all_that_is_new(say_nothing_new=unavailable)
                unavailable = False
            except DatabaseUnavailableError as error:
                # It was there before: it may come back, and nothing is lost meanwhile.
                if not unavailable:
                    terminal.note(f"{error}; trying again every {every_s:g} s")
                unavailable = True
    return DONE


class _Taking:
    def __init__(
        self,
        options: ReadOptions,
        directory: ImportDirectory,
        renaming: Callable[[Log], Log] | None,
        ended: threading.Event,
        import_new: Callable[..., Iterator[Log]],
    ) -> None:
        self._options = options
        self._directory = directory
        self._renaming = renaming
        self._said: set[str] = set()
        self._ended = ended
        self._import_new = import_new

    def all_that_is_new(self, *, say_nothing_new: bool) -> None:
        before = self._directory.rows
        with terminal.working(f"Reading {self._options.table or 'the tag history'}"):
            for log in self._import_new(self._options, self._directory, self._renaming):
                for sentence in log.report.sentences(str(log.path)):
                    if sentence not in self._said:
                        self._said.add(sentence)
                        terminal.note(sentence)
                if self._ended.is_set():
                    break
        new = self._directory.rows - before
        if new or say_nothing_new:
            terminal.results().print(
                f"{self._directory.path}: {new:,} new rows, {self._directory.rows:,} in all",
                markup=False,
                soft_wrap=True,
            )


@contextmanager
def _ending() -> Iterator[threading.Event]:
    """An event that SIGTERM sets, so that a step under way is finished."""
    ended = threading.Event()
    before = signal.signal(signal.SIGTERM, lambda *_: ended.set())
    try:
        yield ended
    finally:
        signal.signal(signal.SIGTERM, before)
