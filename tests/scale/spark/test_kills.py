"""kill -9 of an executor and of the driver: no finding is lost, and none is there twice.

Five times each, at random moments, and into Kafka too: `python -m benches.spark_kills`.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from runglight.model import NominalModel
from runglight.scale import spark as on_spark
from tests.conftest import simulated
from tests.scale import feeding, killing
from tests.scale.feeding import SECOND

if TYPE_CHECKING:
    from pyspark.sql import SparkSession

SILENCE_NS = 400 * SECOND


def prepared(directory: Path, model: NominalModel, pieces: int) -> list[str]:
    """A broken cell's log as files; what one machine finds in it."""
    log = simulated(seed=2, fault=2)
    end_ns = feeding.last_ns(log) + SILENCE_NS
    rows = feeding.cut(feeding.rows_of(log), pieces)
    feeding.write(directory / "in", [*rows, feeding.heartbeat(end_ns)])
    model.save(directory / "model")
    return feeding.by_one_machine(model, log, end_ns - 10 * SECOND)


def test_an_executor(spark: SparkSession, nominal_model: NominalModel, tmp_path: Path) -> None:
    alone = prepared(tmp_path, nominal_model, 8)
    watching = on_spark.watch(
        feeding.stream(spark, tmp_path / "in"),
        nominal_model,
        on_spark.ParquetSink(str(tmp_path / "out")),
        checkpoint=str(tmp_path / "checkpoint"),
        ahead_s=None,
        until_here=True,
    )
    try:
        checkpoint = tmp_path / "checkpoint"
        killing.wait_until(lambda: killing.committed(checkpoint) >= 3, "the third micro-batch")
        first, _ = killing.executors(spark)
        killing.kill(first)
        assert watching.wait(killing.PATIENCE_S)
        assert first not in killing.executors(spark)
    finally:
        watching.stop()
    found = feeding.found(spark, tmp_path / "out")
    assert feeding.each_once(found)
    assert found == alone


def test_the_driver(spark: SparkSession, nominal_model: NominalModel, tmp_path: Path) -> None:
    alone = prepared(tmp_path, nominal_model, 5)
    checkpoint = tmp_path / "checkpoint"
    driver = killing.Driver(tmp_path, "local[2]")
    try:
        killing.wait_until(
            lambda: killing.committed(checkpoint) >= 3 or not driver.running, "the third batch"
        )
        assert driver.running, (tmp_path / "driver.log").read_text(encoding="utf-8")[-2000:]
    finally:
        driver.kill()
    assert killing.committed(checkpoint) < 7
    assert killing.Driver(tmp_path, "local[2]").end() == 0
    found = feeding.found(spark, tmp_path / "out")
    assert feeding.each_once(found)
    assert found == alone
