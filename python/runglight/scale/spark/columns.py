"""The columns of a DataFrame of changes, under our names and in our types."""

from __future__ import annotations

from typing import TYPE_CHECKING

from runglight import _engine
from runglight.errors import InputError

if TYPE_CHECKING:
    from pyspark.sql import Column, DataFrame

EXACT = ("bigint", "int", "smallint", "tinyint", "boolean")
INEXACT = ("double", "float", "decimal")


def changes(
    frame: DataFrame,
    time: str | None = None,
    signal: str | None = None,
    value: str | None = None,
    order: str | None = None,
) -> DataFrame:
    """Columns `time` (bigint nanoseconds), `signal`, `value` (bigint), and `place` for an order.

    What cannot be read of a row is null. Raises InputError where a column is missing or of a type
    that holds nothing of the kind.
    """
    from pyspark.sql import functions as F  # noqa: N812, PLC0415

    found = dict(zip(("time", "signal", "value"), _engine.log_columns(frame.columns), strict=True))
    given = {"time": time, "signal": signal, "value": value}
    names = {role: given[role] or found[role] for role in found}
    if order is not None:
        names["order"] = order
    for role, name in names.items():
        if name is None or name not in frame.columns:
            raise InputError(
                f"learn: the DataFrame has no column {name or role} (it has "
                f"{', '.join(frame.columns)}); name the one that holds it: learn(df, {role}=…)"
            )
    types = dict(frame.dtypes)
    columns = [
        _time(str(names["time"]), types).alias("time"),
        F.col(_quoted(str(names["signal"]))).cast("string").alias("signal"),
        _value(str(names["value"]), types).alias("value"),
    ]
    if order is not None:
        columns.append(_order(order, types).alias("place"))
    return frame.select(*columns)


def _time(name: str, types: dict[str, str]) -> Column:
    from pyspark.sql import functions as F  # noqa: N812, PLC0415

    if types[name] == "bigint":
        return F.col(_quoted(name))
    if types[name] == "timestamp":
        # What nanoseconds cannot hold (after 2262) is no time.
        return F.try_multiply(F.unix_micros(F.col(_quoted(name))), F.lit(1000))
    if types[name] == "timestamp_ntz":
        epoch = "TIMESTAMP_NTZ'1970-01-01 00:00:00'"
        return F.expr(f"try_multiply(timestampdiff(MICROSECOND, {epoch}, {_quoted(name)}), 1000)")
    raise InputError(
        f"learn: column {name} is {types[name]}; make it a timestamp, or bigint nanoseconds since "
        "1970 where microseconds are too coarse"
    )


def _value(name: str, types: dict[str, str]) -> Column:
    from pyspark.sql import functions as F  # noqa: N812, PLC0415

    column = F.col(_quoted(name))
    if types[name] in EXACT:
        return column.cast("bigint")
    if types[name].startswith(INEXACT):
        whole = column.try_cast("bigint")
        return F.when(whole == column, whole)
    raise InputError(
        f"learn: column {name} is {types[name]}; cast it to bigint (booleans are 0 and 1)"
    )


def _order(name: str, types: dict[str, str]) -> Column:
    from pyspark.sql import functions as F  # noqa: N812, PLC0415

    if types[name] in EXACT:
        return F.col(_quoted(name)).cast("bigint")
    raise InputError(f"learn: the order {name} is {types[name]}; give a column of whole numbers")


def _quoted(name: str) -> str:
    return f"`{name.replace('`', '``')}`"
