"""How a log file is read, where sniffing is not enough."""

from typing import Annotated, Any, Literal

import msgspec

Seconds = Annotated[float, msgspec.Meta(ge=0)]


class ReadOptions(msgspec.Struct, forbid_unknown_fields=True, omit_defaults=True):
    """Reader options: keys of `[log]` in `runglight.toml`, arguments of `runglight.read_log`."""

    sql: str | None = None
    """Database to read from, as a URL: `postgresql://user@host/database`, `sqlite:///plant.db`."""
    table: str | None = None
    """Table or view of the database, with its schema where it needs one: `plant.events`."""
    format: Literal["csv", "parquet", "xes", "vcd"] | None = None
    """File format, where content and ending do not tell."""
    time_column: str | None = None
    """Column that holds the time."""
    signal_columns: list[str] = []
    """Long format: the columns that together name the signal. Wide format: the signals to read."""
    value_column: str | None = None
    """Long format: column that holds the value."""
    time_format: str | None = None
    """`iso`, `clock`, `s`, `ms`, `us`, `ns`, `s-year1`, or a pattern: `%d.%m.%Y %H:%M:%S%.f`."""
    date: str | None = None
    """Day of the first row (`2026-01-31`) where the file has only times of day."""
    delimiter: str | None = None
    """Character between the columns of a CSV file."""
    analog: dict[str, float | list[float]] = {}
    """Analog columns to band: the value becomes the number of thresholds it has reached."""
    bits: list[str] = []
    """Words to split into one signal per bit: columns of a wide file, signals of any other."""
    on_error: Literal["fail", "skip"] = "fail"
    """What to do at a row that cannot be read."""
    reorder_s: Seconds = 1.0
    """Rows at most this much older than the row before are sorted in; older ones are errors."""

    def to_json(self) -> str:
        """The options as the engine takes them; what is left at its default is left out."""
        written: dict[str, Any] = msgspec.to_builtins(self)
        # Files are all the engine reads; `log.database` makes one of a table.
        written.pop("sql", None)
        written.pop("table", None)
        if self.analog:
            written["analog"] = [
                (column, threshold)
                for column, thresholds in self.analog.items()
                for threshold in ([thresholds] if isinstance(thresholds, float) else thresholds)
            ]
        return msgspec.json.encode(written).decode()
