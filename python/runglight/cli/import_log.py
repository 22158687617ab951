"""`runglight import`: any log to a change log."""

from __future__ import annotations

from pathlib import Path

import msgspec

from runglight.cli import terminal
from runglight.cli.exit_codes import DONE
from runglight.cli.import_directory import import_to_directory, is_directory
from runglight.cli.reader_options import ReaderOptions, read
from runglight.errors import InputError
from runglight.log.changelog import FORMATS
from runglight.log.symbols import names_by_address, read_symbols, renamed
from runglight.quantities import duration_s


def import_log(
    source: str | None = None,
    /,
    *,
    to: Path,
    follow: bool = False,
    every: str = "5s",
    xes: bool = False,
    options: ReaderOptions | None = None,
) -> int:
    """Turn any log into a change log.

    Reads long or wide CSV, Parquet, XES, VCD, or a table of a database (`--sql`), finds out which
    column is what, and writes one row per change. What could not be read is said, never left out
    in silence.

    From a database it also fills a directory, piece by piece: a second run takes only what is new.
    The directory is read wherever a log is.

    Parameters
    ----------
    source: str
        The log to read; none where `--sql` says what to read.
    to: Path
        The file to write: `.csv`, `.parquet`, `.xes` or `.vcd`; or, with `--sql`, a directory.
    follow: bool
        Keep running, and take what is new in the table again and again.
    every: str
        How long to wait before asking for new rows.
    xes: bool
        The log is XES, whatever its name ends in.

    """
    chosen = options or ReaderOptions()
    if source is None and is_directory(to):
        every_s = duration_s(every, "--every")
        if every_s < 0.01:
            raise InputError(f"--every: {every!r} is too often; write at least 10 ms")
        return import_to_directory(to, chosen, every_s if follow else None)
    if follow:
        raise InputError(
            "--follow: takes a table piece by piece into a directory; "
            "say --sql URL and name a directory in --to"
        )
    return convert_log(source, to, chosen, xes=xes)


def convert_log(source: str | None, to: Path, options: ReaderOptions, *, xes: bool = False) -> int:
    """Reads a log and writes it in the format of the target's ending."""
    if to.suffix.removeprefix(".").lower() not in FORMATS:
        endings = ", ".join(f".{known}" for known in FORMATS)
        raise InputError(f"{to}: cannot tell the format from the ending; use one of {endings}")
    configuration = options.configuration()
    if xes:
        configuration.log = msgspec.structs.replace(configuration.log, format="xes")
    [only] = options.sources(
        [] if source is None else [source], configuration.log, "what shall be read?"
    )
    log = read(only, configuration.log)
    if configuration.symbols.table is not None:
        table = read_symbols(Path(configuration.symbols.table))
        log = renamed(log, names_by_address(table, configuration.symbols.naming))
    with terminal.working(f"Writing {to}"):
        rows = log.write(to)
    terminal.results().print(
        f"{to}: {rows:,} rows of {len(log.signals):,} signals", markup=False, soft_wrap=True
    )
    return DONE
