"""`runglight export`: a change log for other tools."""

from __future__ import annotations

from pathlib import Path

from runglight.cli.import_log import convert_log
from runglight.cli.reader_options import ReaderOptions


def export(log: str | None = None, /, *, to: Path, options: ReaderOptions | None = None) -> int:
    """Write a log for another tool.

    CSV and Parquet for tables, XES for process mining, VCD for waveform viewers (GTKWave,
    Surfer, sigrok).

    Parameters
    ----------
    log: str
        The log to read; none where `--sql` says what to read.
    to: Path
        The file to write: `.csv`, `.parquet`, `.xes` or `.vcd`.

    """
    return convert_log(log, to, options or ReaderOptions())
