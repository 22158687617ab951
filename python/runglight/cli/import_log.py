"""`runglight import`: any log to a change log."""

from __future__ import annotations

from pathlib import Path

from runglight.cli import terminal
from runglight.cli.exit_codes import DONE
from runglight.cli.reader_options import ReaderOptions, read
from runglight.errors import InputError
from runglight.log.changelog import FORMATS
from runglight.log.symbols import names_by_address, read_symbols, renamed


def import_log(
    source: str | None = None, /, *, to: Path, options: ReaderOptions | None = None
) -> int:
    """Turn any log into a change log.

    Reads long or wide CSV, Parquet, XES, VCD, or a table of a database (`--sql`), finds out which
    column is what, and writes one row per change. What could not be read is said, never left out
    in silence.

    Parameters
    ----------
    source: str
        The log to read; none where `--sql` says what to read.
    to: Path
        The file to write: `.csv`, `.parquet`, `.xes` or `.vcd`.

    """
    return convert_log(source, to, options or ReaderOptions())


def convert_log(source: str | None, to: Path, options: ReaderOptions) -> int:
    """Reads a log and writes it in the format of the target's ending."""
    if to.suffix.removeprefix(".").lower() not in FORMATS:
        endings = ", ".join(f".{known}" for known in FORMATS)
        raise InputError(f"{to}: cannot tell the format from the ending; use one of {endings}")
    configuration = options.configuration()
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
