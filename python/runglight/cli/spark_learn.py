"""`runglight spark learn`: a model of a log that one machine would not hold."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import msgspec
from cyclopts import Parameter

from runglight.cli import terminal
from runglight.cli.exit_codes import DONE
from runglight.cli.learn import LearningOptions, parameters_of, save_learned, say_learned
from runglight.cli.spark_options import SparkOptions
from runglight.configuration import Configuration

if TYPE_CHECKING:
    from pyspark.sql import DataFrame, SparkSession

_TABLE = "table:"
_JDBC = "jdbc:"


def spark_learn(
    log: str,
    /,
    *,
    output: Annotated[Path, Parameter(name=["--output", "-o"])],
    symbols: Path | None = None,
    naming: str | None = None,
    time_column: str | None = None,
    signal_column: str | None = None,
    value_column: str | None = None,
    order_column: str | None = None,
    learning: LearningOptions | None = None,
    spark: SparkOptions | None = None,
) -> int:
    """Learn with Spark what nominal looks like: the model is that of `runglight learn`.

    The log is read twice; each group of the plant is then learned in a task of its own.

    Parameters
    ----------
    log: str
        A directory (or file) of Parquet, also `s3a://…` or `hdfs://…`; `table:NAME` for a table
        that Spark knows (Iceberg, Delta, Hive); `jdbc:…#TABLE`.
    output: Path
        Directory to write the model to, on the driver's disk; a model that is there is replaced.
    symbols: Path
        Symbol table: `address,group,device,signal,class,type,description`.
    naming: str
        How names split where no table tells (default: `{group}-{device}-{signal}`).
    time_column: str
        Column with the time: a timestamp, or nanoseconds since 1970 (default: found by its name).
    signal_column: str
        Column with the signal (default: found by its name).
    value_column: str
        Column with the value (default: found by its name).
    order_column: str
        Column of whole numbers that says in which order rows of one time happened.

    """
    configuration = Configuration()
    if naming is not None:
        configuration.symbols.naming = naming
    parameters: dict[str, Any] = msgspec.to_builtins(
        parameters_of(configuration, learning or LearningOptions())
    )
    with (spark or SparkOptions()).session() as session:
        from runglight.scale.spark import learn  # noqa: PLC0415

        with terminal.working("Learning"):
            model = learn(
                _frame(session, log),
                symbols,
                time=time_column,
                signal=signal_column,
                value=value_column,
                order=order_column,
                source=[log],
                **parameters,
            )
            save_learned(model, output)
    say_learned(model, output)
    return DONE


def _frame(session: SparkSession, log: str) -> DataFrame:
    if log.startswith(_TABLE):
        return session.table(log.removeprefix(_TABLE))
    if log.startswith(_JDBC):
        url, _, table = log.partition("#")
        return session.read.format("jdbc").options(url=url, dbtable=table or "log").load()
    from runglight.scale.spark.parquet_path import parquet_path  # noqa: PLC0415

    return session.read.parquet(parquet_path(session, log))
