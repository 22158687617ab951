"""Streams on a real cluster find what one machine finds."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import pyarrow as pa
import pytest

from runglight.errors import InputError
from runglight.model import NominalModel
from runglight.scale import spark as on_spark
from tests.conftest import simulated
from tests.scale import feeding
from tests.scale.feeding import SECOND

if TYPE_CHECKING:
    from pyspark.sql import SparkSession

SILENCE_NS = 400 * SECOND


def watched(
    spark: SparkSession, directory: Path, model: object, *, checkpoint: str | None = "checkpoint"
) -> list[str]:
    """Findings of the files in `in`, all of them judged."""
    watching = on_spark.watch(
        feeding.stream(spark, directory / "in", 1),
        model,  # type: ignore[arg-type]
        directory / "out",
        checkpoint=None if checkpoint is None else str(directory / checkpoint),
        ahead_s=None,
        until_here=True,
    )
    try:
        assert watching.wait(240)
    finally:
        watching.stop()
    return feeding.found(spark, directory / "out")


def test_disorder_silence_and_several_plants(
    spark: SparkSession, nominal_model: NominalModel, tmp_path: Path
) -> None:
    # Two plants by one model: each finds its own, and a third has none.
    broken = {"north": simulated(seed=2, fault=2), "south": simulated(seed=3, fault=9)}
    end_ns = max(map(feeding.last_ns, broken.values())) + SILENCE_NS
    rows = [
        feeding.rows_of(log, plant, number) for number, (plant, log) in enumerate(broken.items())
    ]
    rows.append(feeding.rows_of(simulated(seed=4).slice(0, 20), "east", 2))
    together = feeding.disordered(pa.concat_tables(rows), 9.0)
    feeding.write(tmp_path / "in", [*feeding.cut(together, 3), feeding.heartbeat(end_ns)])

    lines = watched(spark, tmp_path, dict.fromkeys(broken, nominal_model))

    [homeless] = [line for line in lines if "Plant east has no model" in line]
    lines.remove(homeless)
    alone = [
        feeding.by_one_machine(nominal_model, log, end_ns - 10 * SECOND) for log in broken.values()
    ]
    assert all(alone)
    assert any('"stall"' in line for line in lines)
    assert lines == sorted(alone[0] + alone[1])


def test_a_body_shop(spark: SparkSession, tmp_path: Path) -> None:
    model, log = feeding.body_shop()
    end_ns = feeding.last_ns(log) + SILENCE_NS
    stranger = feeding.rows_of(log.slice(len(log) // 2, 1)).set_column(
        1, "signal", pa.array(["Group1-Grown-Sensor"])
    )
    first, second = feeding.cut(feeding.rows_of(log), 2)
    # A row of the same time comes after those of its time.
    rows = pa.concat_tables([first, stranger, second])
    feeding.write(tmp_path / "in", [*feeding.cut(rows, 2), feeding.heartbeat(end_ns)])

    lines = watched(spark, tmp_path, model, checkpoint=None)

    [grown] = [line for line in lines if '"unknown_signal"' in line]
    assert json.loads(grown)["signal"] == "Group1-Grown-Sensor"
    lines.remove(grown)
    alone = feeding.by_one_machine(model, log, end_ns - 10 * SECOND)
    assert len(alone) > 10
    assert lines == alone


def test_late_rows_are_told_and_a_stream_goes_on_from_its_checkpoint(
    spark: SparkSession, nominal_model: NominalModel, tmp_path: Path
) -> None:
    log = simulated(seed=2, fault=1)
    early, held_back, rest = feeding.cut(feeding.rows_of(log), 3)
    feeding.write(tmp_path / "in", [early, rest, feeding.heartbeat(feeding.last_ns(log))])
    before = watched(spark, tmp_path, nominal_model)
    assert not any("too late" in line for line in before)
    feeding.write(tmp_path / "in", [held_back], first=10)

    after = watched(spark, tmp_path, nominal_model)

    assert set(before) <= set(after)
    [late] = [line for line in after if "too late" in line]
    assert f"{len(held_back)} changes came too late" in json.loads(late)["message"]


@pytest.mark.parametrize(
    ("columns", "told"),
    [
        ("time bigint, tag string, value bigint", "has no column signal"),
        ("time string, signal string, value bigint", "column time is string"),
        ("time bigint, signal string, value double", "column value is double"),
    ],
)
def test_a_stream_that_is_no_change_log(
    spark: SparkSession, nominal_model: NominalModel, tmp_path: Path, columns: str, told: str
) -> None:
    (tmp_path / "in").mkdir()
    stream = spark.readStream.schema(columns).parquet(str(tmp_path / "in"))
    with pytest.raises(InputError, match=told):
        on_spark.watch(
            stream,
            nominal_model,
            on_spark.ParquetSink("out"),
            checkpoint=str(tmp_path / "checkpoint"),
        )
