"""The change log: all events of a plant in time order."""

from __future__ import annotations

import os
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec

from runglight import _engine
from runglight.errors import InputError
from runglight.log.options import ReadOptions
from runglight.log.report import ReadReport
from runglight.recording.layout import is_recording
from runglight.strictly import convert

if TYPE_CHECKING:
    from collections.abc import Sequence
    from os import PathLike

_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)

FORMATS = ("csv", "parquet", "xes", "vcd")


class Log:
    """A change log in memory: columns `time`, `signal`, `value`.

    It goes without a copy to everything that speaks Arrow: `pyarrow.table(log)`,
    `polars.DataFrame(log)`.
    """

    def __init__(
        self,
        engine_log: _engine.ChangeLog,
        path: str | None = None,
        report: ReadReport | None = None,
    ) -> None:
        self._engine = engine_log
        self._report = report
        self.path = path

    @classmethod
    def from_arrow(cls, table: Any, *, reorder_s: float = 1.0) -> Log:
        """From a pyarrow, polars or pandas (2.2 or newer) table: `time`, `signal`, `value`."""
        return cls(_engine.ChangeLog.from_arrow(arrow_table(table), reorder_s))

    @classmethod
    def from_columns(
        cls,
        time_ns: Any,
        signal_index: Any,
        value: Any,
        signals: Sequence[str],
        scan_interval_s: float | None = None,
        *,
        gaps: Sequence[tuple[int, int]] = (),
    ) -> Log:
        """From numpy arrays (int64, uint32, int64) and the names the indices stand for.

        `gaps` are the stretches (start and end in nanoseconds) in which nothing was recorded.
        """
        interval_ns = None if scan_interval_s is None else round(scan_interval_s * 1e9)
        return cls(
            _engine.log_from_columns(
                time_ns, signal_index, value, list(signals), interval_ns, list(gaps)
            )
        )

    def __len__(self) -> int:
        return len(self._engine)

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        return self._engine.__arrow_c_stream__(requested_schema)

    def __repr__(self) -> str:
        return f"<runglight.Log of {len(self):,} rows, {len(self.signals)} signals>"

    @property
    def engine(self) -> _engine.ChangeLog:
        """The compiled engine's log."""
        return self._engine

    @property
    def signals(self) -> list[str]:
        """Names of the signals, in the order of their indices."""
        return self._engine.signals

    @property
    def start(self) -> datetime | None:
        """Time of the first row (to the microsecond), or None for an empty log."""
        return _datetime(self._engine.start_ns)

    @property
    def end(self) -> datetime | None:
        """Time of the last row (to the microsecond), or None for an empty log."""
        return _datetime(self._engine.end_ns)

    @property
    def gaps(self) -> list[tuple[datetime, datetime]]:
        """Stretches in which nothing was recorded."""
        return [(_utc(start), _utc(end)) for start, end in self._engine.gaps]

    @property
    def scan_interval_s(self) -> float | None:
        """Seconds between two scans or samples, where the source tells."""
        interval_ns = self._engine.scan_interval_ns
        return None if interval_ns is None else interval_ns / 1e9

    @property
    def report(self) -> ReadReport:
        """What reading did, and what it left out."""
        return self._report or msgspec.json.decode(self._engine.report_json, type=ReadReport)

    def columns(self) -> tuple[Any, Any, Any]:
        """`(time_ns, signal_index, value)` as numpy arrays."""
        return self._engine.columns()

    def slice(self, offset: int, length: int | None = None) -> Log:
        """Some of the rows, without a copy of their names."""
        return Log(self._engine.slice(offset, length), self.path, self._report)

    def renamed(self, signals: Sequence[str]) -> Log:
        """The same rows with other names of the signals, in the order of their indices."""
        return Log(self._engine.with_signals(list(signals)), self.path, self._report)

    def split_words(self, words: Sequence[str]) -> Log:
        """The same log with some of its words split into one signal per bit that is ever set."""
        return Log(self._engine.split_words(list(words)), self.path, self._report)

    def write(self, path: str | PathLike[str], format: str | None = None) -> int:
        """Writes the log as CSV, Parquet, XES or VCD (by the ending); returns rows written.

        The file appears whole or not at all.
        """
        target = Path(path)
        chosen = format or target.suffix.removeprefix(".").lower()
        if chosen not in FORMATS:
            raise InputError(
                f"{target}: cannot tell the format from the ending; "
                f"end the name in {', '.join('.' + known for known in FORMATS)}"
            )
        return _engine.write_log(self._engine, os.fspath(target), chosen)


def read_log(source: str | PathLike[str] | Any = None, **options: Any) -> Log:
    """Reads CSV, Parquet, XES, VCD, or the directory of a recording.

    Without a source, the table that `sql` and `table` name.

    A directory that `runglight import --sql … --to DIR` filled is read too, and a pyarrow, polars
    or pandas (2.2 or newer) table with the columns `time`, `signal`, `value`.

    `options` are the fields of `runglight.ReadOptions`; of a table in memory only `bits` and
    `reorder_s` mean something. Raises InputError for anything else.
    """
    checked = convert(options, ReadOptions, "read_log")
    if (source is None) == (checked.sql is None):
        raise InputError("read_log: give either the path of a file, or sql and table")
    if source is None or isinstance(source, str | os.PathLike):
        return read_log_with(source, checked)
    idle = sorted(options.keys() - {"bits", "reorder_s"})
    if idle:
        raise InputError(
            f"read_log: {', '.join(idle)} says how a file is read; leave it out for a table"
        )
    return split_words(Log.from_arrow(source, reorder_s=checked.reorder_s), checked.bits)


def read_log_with(path: str | PathLike[str] | None, options: ReadOptions) -> Log:
    """Reads a log or a recording with checked options; None stands for the table they name."""
    if path is None:
        return _read_table(options)
    if Path(path).is_dir():
        from runglight.log.imported import is_imported, read_imported  # noqa: PLC0415

        if is_imported(Path(path)):
            return split_words(read_imported(Path(path)), options.bits)
    text = os.fspath(path)
    if is_recording(Path(text)):
        # Loaded when there is one: a recording needs SQLite and NumPy.
        from runglight.recording.read import read_recording  # noqa: PLC0415

        return split_words(read_recording(text), options.bits)
    return Log(_engine.read_log(text, options.to_json()), text)


def split_words(log: Log, words: Sequence[str]) -> Log:
    """The log with words split, of a recording also by their addresses.

    A word that was recorded under a name is called by its address again, so that its bits are
    called by theirs, and a symbol table finds them.
    """
    if not words:
        return log
    if log.path is not None and is_recording(Path(log.path)):
        from runglight.recording.description import read_description  # noqa: PLC0415

        recorded = read_description(Path(log.path)).signals
        address_of = {signal.name: signal.address or signal.name for signal in recorded}
        wanted = {address_of.get(word, word) for word in words}
        signals = [
            name if address_of[name] not in wanted else address_of[name] for name in log.signals
        ]
        log, words = log.renamed(signals), sorted(wanted)
    try:
        return log.split_words(words)
    except InputError as error:
        raise InputError(f"{log.path}: {error}") from None


def as_log(log: Log | Any) -> Log:
    """The log itself, or the log of an Arrow table. InputError where it is neither."""
    return log if isinstance(log, Log) else Log.from_arrow(log)


def arrow_table(table: Any) -> Any:
    """The table itself. InputError where it does not speak Arrow."""
    if not hasattr(table, "__arrow_c_stream__"):
        raise InputError(
            f"what is of type {type(table).__name__} is no Arrow table: pass a pyarrow or polars "
            "table, a pandas (2.2 or newer) data frame, or what read_log makes of a file's path"
        )
    return table


def _read_table(options: ReadOptions) -> Log:
    try:
        from runglight.log.database import read_table  # noqa: PLC0415
    except ModuleNotFoundError as missing:
        if missing.name != "sqlalchemy":
            raise
        raise InputError(
            'reading from a database needs SQLAlchemy: pip install "runglight[sql]"'
        ) from None
    return read_table(options)


def _datetime(time_ns: int | None) -> datetime | None:
    return None if time_ns is None else _utc(time_ns)


def _utc(time_ns: int) -> datetime:
    return _EPOCH + timedelta(microseconds=time_ns // 1000)
