"""What a cluster learns is what one machine learns, byte for byte."""

from __future__ import annotations

import random
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from runglight.errors import InputError
from runglight.log.changelog import Log
from runglight.model import learn as learn_here
from runglight.plants import PLANTS, write_symbols
from runglight.plants.bodyshop import simulate_bodyshop
from tests.conftest import simulated
from tests.scale.test_lessons import same_directories

if TYPE_CHECKING:
    from pyspark.sql import DataFrame, SparkSession


def learn(frame: DataFrame, *arguments: Any, **options: Any) -> Any:
    """Loaded when Spark is there."""
    from runglight.scale.spark import learn as learn_there  # noqa: PLC0415

    return learn_there(frame, *arguments, **options)


def rows_of(log: Log) -> pa.Table:
    """Time in nanoseconds, name, value, and the number of the row."""
    time_ns, signal, value = log.columns()
    names = pa.array(np.array(log.signals, object)[signal])
    return pa.table({"time": time_ns, "signal": names, "value": value, "row": range(len(log))})


def here(rows: pa.Table) -> Log:
    """One machine's log of rows in order."""
    times = rows["time"].cast(pa.timestamp("ns", "UTC"))
    return Log.from_arrow(rows.select(["time", "signal", "value"]).set_column(0, "time", times))


def there(spark: SparkSession, rows: pa.Table, directory: Path, files: int = 3) -> DataFrame:
    """The rows in disorder, in several files."""
    directory.mkdir()
    order = list(range(len(rows)))
    random.Random(5).shuffle(order)
    for number in range(files):
        pq.write_table(rows.take(order[number::files]), directory / f"{number}.parquet")
    return spark.read.parquet(str(directory))


@pytest.mark.parametrize("timing", ["adaptive", "plat"])
def test_a_body_shop(spark: SparkSession, timing: str, tmp_path: Path) -> None:
    run = simulate_bodyshop("tiny", learn_events=12_000, watch_events=1_000).learn
    rows = rows_of(Log.from_columns(run.time_ns, run.signal_index, run.value, run.signals))
    frame = there(spark, rows, tmp_path / "rows")
    model = learn(frame, order="row", timing=timing, source=["rows"])
    assert model.summary()["source"] == ["rows"]
    same_directories(model, learn_here(here(rows), timing=timing), tmp_path)


def test_rows_that_tell_no_order(spark: SparkSession, tmp_path: Path) -> None:
    rows = rows_of(simulated()).sort_by(
        [("time", "ascending"), ("signal", "ascending"), ("value", "ascending")]
    )
    time_ns = rows["time"].to_numpy()
    silent = (int(time_ns[400]), int(time_ns[500]))
    rows = rows.filter(pa.array((time_ns <= silent[0]) | (time_ns >= silent[1])))
    symbols = tmp_path / "symbols.csv"
    write_symbols(PLANTS["cell"].symbols, symbols)
    log = here(rows)
    log = Log.from_columns(*log.columns(), log.signals, gaps=[silent])
    # Under other names and types: what a historian has.
    written = rows.drop_columns("row").rename_columns(["Time stamp", "Symbol name", "Status"])
    times = written["Time stamp"].cast(pa.timestamp("ns", "UTC")).cast(pa.timestamp("us", "UTC"))
    written = written.set_column(0, "Time stamp", times)
    written = written.set_column(2, "Status", written["Status"].cast(pa.float64()))
    frame = there(spark, written, tmp_path / "rows")
    model = learn(frame, symbols, gaps=[silent])
    same_directories(model, learn_here(log, symbols=symbols), tmp_path)


def test_what_cannot_be_learned_is_said(spark: SparkSession) -> None:
    def frame(schema: str, *rows: tuple[Any, ...]) -> DataFrame:
        return spark.createDataFrame(list(rows), schema)

    long = "time long, signal string, value long"
    with pytest.raises(InputError, match="no change of any signal"):
        learn(frame(long))
    with pytest.raises(InputError, match=r"1 of 2 rows cannot be read; one has no value \(time 2"):
        learn(frame(long, (1, "G-D-A", 1), (2, "G-D-A", None)))
    with pytest.raises(InputError, match=r"no column time \(it has a, signal, value\)"):
        learn(frame("a long, signal string, value long"))
    with pytest.raises(InputError, match="no column offset"):
        learn(frame(long), order="offset")
    with pytest.raises(InputError, match="column time is string; make it a timestamp"):
        learn(frame("time string, signal string, value long"))
    with pytest.raises(InputError, match="column value is string; cast it"):
        learn(frame("time long, signal string, value string"))
    with pytest.raises(InputError, match="one has no value"):
        learn(frame("time long, signal string, value double", (1, "A", 0.5)))
    late = "timestamp_micros(9999999999999999) time, 'A' signal, 1 value"
    with pytest.raises(InputError, match=r"one has no time \(signal A"):
        learn(spark.range(1).selectExpr(*late.split(", ")))
    with pytest.raises(InputError, match="unknown key 'tming'"):
        learn(frame(long), tming="plat")
