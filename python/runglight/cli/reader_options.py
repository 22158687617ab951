"""Options that several commands share: how logs are read, and which configuration holds."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import msgspec
from cyclopts import Parameter

from runglight.cli import terminal
from runglight.configuration import Configuration, check_naming, load_configuration
from runglight.errors import InputError
from runglight.log.changelog import Log, read_log_with, split_words
from runglight.log.options import ReadOptions
from runglight.quantities import duration_s
from runglight.recording.layout import is_recording
from runglight.taps import is_live

if TYPE_CHECKING:
    from collections.abc import Sequence


@Parameter(name="*", group="Reading logs")
@dataclass(frozen=True, kw_only=True)
class ReaderOptions:
    """How logs are read. Everything is found out from the file where it is not said here."""

    sql: str | None = None
    "Database to read from instead of a file: `postgresql://user@host/database`."
    table: str | None = None
    "Table or view of the database."
    time_column: str | None = None
    "Column that holds the time."
    signal_column: tuple[str, ...] = ()
    "Column that names the signal; repeat it, or join with commas, where several name it together."
    value_column: str | None = None
    "Column that holds the value."
    time_format: str | None = None
    "`iso`, `clock`, `s`, `ms`, `us`, `ns`, or a pattern like `%d.%m.%Y %H:%M:%S%.f`."
    date: str | None = None
    "Day of the first row (`2026-01-31`), where the file has only times of day."
    delimiter: str | None = None
    "Character between columns; `tab` for a tabulator."
    analog: tuple[str, ...] = ()
    "`COLUMN=THRESHOLD[,THRESHOLD…]`: read an analog column as the number of thresholds reached."
    bits: tuple[str, ...] = ()
    "Word to split into one signal per bit: `%MW74` becomes `%MW74.0` and up."
    on_error: Literal["fail", "skip"] | None = None
    "What to do at a row that cannot be read (default: fail). Skipped rows are counted and shown."
    reorder: str | None = None
    "Sort rows in that are at most this late (default: `1s`); later ones are errors."
    naming: str | None = None
    "How names split into group, device and signal (default: `{group}-{device}-{signal}`)."
    symbols: Path | None = None
    "Symbol table: `address,group,device,signal,class,type,description`."
    config: Annotated[Path | None, Parameter(name=["--config", "-c"])] = None
    "Configuration file (default: `runglight.toml`, if there is one)."

    def configuration(self) -> Configuration:
        """The configuration file with these options laid over it."""
        configuration = load_configuration(self.config)
        configuration.log = self._log(configuration.log)
        if self.naming is not None:
            try:
                check_naming(self.naming)
            except ValueError as error:
                raise InputError(f"--naming: {error}") from None
            configuration.symbols.naming = self.naming
        if self.symbols is not None:
            configuration.symbols.table = str(self.symbols)
        return configuration

    def sources(
        self, named: Sequence[Path | str], file: ReadOptions, question: str
    ) -> list[Path | str | None]:
        """The logs to read: those named, else the table (as None); asks `question` for neither."""
        if named and (self.sql is not None or self.table is not None):
            raise InputError(f"{named[0]}: leave it out where --sql and --table say what to read")
        if named:
            return list(named)
        if file.sql is not None:
            return [None]
        if file.table is not None:
            raise InputError("--table: say with --sql in which database it is")
        raise InputError(f"{question} name a log, or a table with --sql URL --table T")

    def _log(self, file: ReadOptions) -> ReadOptions:
        said = {
            "sql": self.sql,
            "table": self.table,
            "time_column": self.time_column,
            "signal_columns": _listed(self.signal_column) or None,
            "value_column": self.value_column,
            "time_format": self.time_format,
            "date": self.date,
            "delimiter": None if self.delimiter is None else _delimiter(self.delimiter),
            "analog": dict(_analog(text) for text in self.analog) or None,
            "bits": _listed(self.bits) or None,
            "on_error": self.on_error,
            "reorder_s": None if self.reorder is None else duration_s(self.reorder, "--reorder"),
        }
        changes = {key: value for key, value in said.items() if value is not None}
        return msgspec.structs.replace(file, **changes)


def read(path: Path | str | None, options: ReadOptions, *, to_its_end: bool = False) -> Log:
    """Reads a log (None: the table the options name) and tells the user what was left out.

    With `to_its_end` a recording is closed where recording ended; see `log_to_its_end`.
    """
    if path is not None:
        refuse_live(str(path))
    with terminal.working(f"Reading {options.table if path is None else path}"):
        if to_its_end and path is not None and is_recording(Path(path)):
            # NumPy is loaded where a recording is read.
            from runglight.recording.read import log_to_its_end  # noqa: PLC0415

            log = split_words(log_to_its_end(path), options.bits)
        else:
            log = read_log_with(path, options)
    for sentence in log.report.sentences(str(log.path)):
        terminal.note(sentence)
    return log


def refuse_live(source: str) -> None:
    """A live source is no log yet."""
    if is_live(source):
        # A path has lost one of the two slashes.
        shown = re.sub(r"^(\w+):/(?=[^/])", r"\1://", source)
        raise InputError(
            f"{shown}: this is a live source, and a log is needed here; "
            "record it first: runglight record URL --to DIR"
        )


def _listed(texts: tuple[str, ...]) -> list[str]:
    return [part.strip() for text in texts for part in text.split(",") if part.strip()]


def _delimiter(text: str) -> str:
    delimiter = {"tab": "\t", "\\t": "\t", "space": " "}.get(text.lower(), text)
    if len(delimiter) != 1:
        raise InputError(f"--delimiter: {text!r} must be one character, or the word tab")
    return delimiter


def _analog(text: str) -> tuple[str, list[float]]:
    column, separator, thresholds = text.rpartition("=")
    try:
        values = [float(threshold) for threshold in thresholds.split(",")]
    except ValueError:
        values = []
    if not (separator and column and values):
        raise InputError(f"--analog: {text!r} must be COLUMN=THRESHOLD[,THRESHOLD…]")
    return column, values
