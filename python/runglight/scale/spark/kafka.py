"""Changes from a Kafka topic."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import pyarrow as pa

from runglight.errors import InputError
from runglight.nearest import suggestion
from runglight.scale.spark.changes import Changes, names
from runglight.scale.spark.message_formats import FORMATS

if TYPE_CHECKING:
    from pyspark.sql import DataFrame, SparkSession

Format: TypeAlias = Literal["json", "binary", "arrow"]


@dataclass(frozen=True)
class KafkaReader:
    """Reads record batches of `value`, `partition`, `offset` (and `key`)."""

    format: Format
    plant_by_key: bool

    def __call__(self, batch: pa.RecordBatch) -> Changes:
        """Changes of one record batch."""
        columns = dict(zip(batch.schema.names, batch.columns, strict=True))
        changes = FORMATS[self.format](columns["value"], columns["partition"], columns["offset"])
        if not self.plant_by_key or self.format == "arrow":
            return changes
        if len(changes) != len(batch):
            # Some could not be read: the rest is read again, each with its key.
            return self._one_by_one(columns, changes)
        return _called(changes, columns["key"])

    def _one_by_one(self, columns: Mapping[str, Any], changes: Changes) -> Changes:
        decode = FORMATS[self.format]
        kept = [
            row
            for row in range(len(columns["value"]))
            if len(
                decode(
                    columns["value"].slice(row, 1),
                    columns["partition"].slice(row, 1),
                    columns["offset"].slice(row, 1),
                )
            )
        ]
        return _called(changes, columns["key"].take(pa.array(kept, pa.int64())))


@dataclass(frozen=True)
class KafkaChanges:
    """A topic as a stream of changes; `frame` is the DataFrame of its messages."""

    frame: DataFrame
    reader: KafkaReader


def from_kafka(
    spark: SparkSession,
    servers: str | Sequence[str],
    topic: str | Sequence[str],
    format: Format = "json",
    *,
    starting: Literal["earliest", "latest"] | str = "earliest",
    plant_by_key: bool = False,
    rows_at_once: int | None = 2_000_000,
    **options: str,
) -> KafkaChanges:
    """Changes from one or several topics.

    `format` is `json`, `binary` or `arrow` (`message_formats` says what each is). With
    `plant_by_key` the key of a message names its plant. `rows_at_once` bounds the messages of one
    micro-batch, `starting` is where a watch without a checkpoint begins, and `options` are those
    of Spark's Kafka source (`kafka.security.protocol="SASL_SSL"`).
    """
    if format not in FORMATS:
        raise InputError(f"from_kafka: {format!r} is no format{suggestion(format, list(FORMATS))}")
    server_list = servers if isinstance(servers, str) else ",".join(servers)
    topic_list = topic if isinstance(topic, str) else ",".join(topic)
    reader = spark.readStream.format("kafka").options(
        **{
            "kafka.bootstrap.servers": server_list,
            "subscribe": topic_list,
            "startingOffsets": starting,
            "includeHeaders": "false",
            **options,
        }
    )
    if rows_at_once is not None:
        reader = reader.option("maxOffsetsPerTrigger", str(rows_at_once))
    columns = ["value", "partition", "offset", *(["key"] if plant_by_key else [])]
    return KafkaChanges(reader.load().select(*columns), KafkaReader(format, plant_by_key))


def _called(changes: Changes, keys: Any) -> Changes:
    plant = names(keys.cast(pa.string()).fill_null(""))
    return Changes(
        changes.time_ns,
        changes.signal,
        changes.value,
        plant,
        changes.partition,
        changes.offset,
        changes.unreadable,
        changes.first,
    )
