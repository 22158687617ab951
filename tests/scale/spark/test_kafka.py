"""A real broker: changes from topics, findings to one, and a model replaced on the way."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pyarrow as pa

from runglight.log.changelog import Log
from runglight.model import NominalModel, learn
from runglight.scale import spark as on_spark
from runglight.scale.wire import encode_binary
from tests.conftest import simulated
from tests.scale import feeding
from tests.scale.broker import Broker
from tests.scale.feeding import SECOND

if TYPE_CHECKING:
    from pyspark.sql import SparkSession

SILENCE_NS = 400 * SECOND


def changes(log: Log) -> list[tuple[int, str, int]]:
    time_ns, index, value = log.columns()
    names = np.array(log.signals, object)[index]
    return list(zip(time_ns.tolist(), names.tolist(), value.tolist(), strict=True))


def as_json(time_ns: int, signal: str, value: int) -> bytes:
    return json.dumps({"time": time_ns, "signal": signal, "value": value}).encode()


def test_json_in_findings_out(
    spark: SparkSession, broker: Broker, nominal_model: NominalModel, tmp_path: Path
) -> None:
    # Two PLCs of one plant, each with a partition; rows of one time stand by partition.
    log = simulated(seed=2, fault=2)
    rows = changes(log)
    plc = [sum(signal.encode()) % 2 for _, signal, _ in rows]
    order = sorted(range(len(rows)), key=lambda row: (rows[row][0], plc[row]))
    end_ns = feeding.last_ns(log) + SILENCE_NS
    broker.create("cell", partitions=2)
    broker.create("findings")
    for number in (0, 1):
        sent = [as_json(*row) for row, of in zip(rows, plc, strict=True) if of == number]
        if number:
            sent.insert(len(sent) // 2, b'{"time": "yesterday"')
        sent.append(json.dumps({"time": end_ns}).encode())
        broker.send("cell", [(None, message) for message in sent], number)

    url = f"jdbc:h2:{tmp_path / 'database'};AUTO_SERVER=TRUE"
    watching = on_spark.watch(
        on_spark.from_kafka(spark, broker.servers, "cell", rows_at_once=500),
        nominal_model,
        [
            on_spark.KafkaSink(broker.servers, "findings"),
            on_spark.JdbcSink(url, options={"driver": "org.h2.Driver"}),
        ],
        checkpoint=str(tmp_path / "checkpoint"),
        delay_s=120,
        ahead_s=None,
        until_here=True,
    )
    try:
        assert watching.wait(240)
    finally:
        watching.stop()

    sent_out = broker.received("findings")
    assert {key for key, _ in sent_out} == {b""}
    lines = sorted(value.decode() for _, value in sent_out)
    [unreadable] = [line for line in lines if "could not be read" in line]
    assert "1 message could not be read" in unreadable
    lines.remove(unreadable)
    table = pa.Table.from_arrays(
        [pa.array(column) for column in zip(*(rows[row] for row in order), strict=True)],
        names=["time", "signal", "value"],
    )
    as_sent = table.set_column(0, "time", table["time"].cast(pa.timestamp("ns", "UTC")))
    alone = feeding.by_one_machine(nominal_model, Log.from_arrow(as_sent), end_ns - 120 * SECOND)
    assert len(alone) > 10
    assert lines == alone
    stored = spark.read.format("jdbc").options(url=url, dbtable="findings", driver="org.h2.Driver")
    assert sorted(row["finding"] for row in stored.load().select("finding").collect()) == sorted(
        [*alone, unreadable]
    )


def test_a_model_is_replaced_on_the_way(
    spark: SparkSession, broker: Broker, nominal_model: NominalModel, tmp_path: Path
) -> None:
    # The broken cell is taken for granted by a model that learned of it.
    log = simulated(seed=2, fault=2)
    knowing = learn([simulated(), log])
    half, end_ns = len(log) // 2, feeding.last_ns(log) + SILENCE_NS
    messages = [(b"north", encode_binary(*row)) for row in changes(log)]
    broker.create("binary")
    broker.send("binary", messages[:half])
    watching = on_spark.watch(
        on_spark.from_kafka(spark, broker.servers, "binary", "binary", plant_by_key=True),
        {"north": nominal_model},
        on_spark.ParquetSink(str(tmp_path / "out")),
        checkpoint=str(tmp_path / "checkpoint"),
        ahead_s=None,
    )
    try:
        watching.query.processAllAvailable()
        assert not watching.replace_model({"north": nominal_model})
        assert watching.replace_model({"north": knowing})
        broker.send("binary", [*messages[half:], (b"", encode_binary(end_ns, "", 0))])
        watching.query.processAllAvailable()
    finally:
        watching.stop()

    found = feeding.found(spark, tmp_path / "out")
    [replaced] = [line for line in found if "another model watches" in line]
    found.remove(replaced)
    time_ns = log.columns()[0]
    judged = int(np.searchsorted(time_ns, time_ns[half - 1] // 10**6 * 10**6 - 10 * SECOND))
    before = nominal_model.monitor().observe(log.slice(0, judged)).json_lines()
    after = feeding.by_one_machine(knowing, log.slice(judged), end_ns - 10 * SECOND)
    assert before
    assert found == sorted(before + after)
