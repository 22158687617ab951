"""Streams and sinks as the command line names them.

kafka://HOST:PORT[,HOST:PORT…]/TOPIC[,TOPIC…][?option=value]     options are those of Spark
DIRECTORY or parquet:DIRECTORY                                    also hdfs://, s3a://, …
jdbc:…                                                            findings only
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from runglight.scale.spark.frames import OPTIONAL
from runglight.scale.spark.kafka import Format, KafkaChanges, from_kafka
from runglight.scale.spark.parquet_path import PREFIX, parquet_path
from runglight.scale.spark.sinks import FindingSink, JdbcSink, KafkaSink, ParquetSink
from runglight.scale.topic import SCHEME, topic_of

if TYPE_CHECKING:
    from pyspark.sql import DataFrame, SparkSession

_JDBC = "jdbc:"


def stream_of(
    spark: SparkSession,
    place: str,
    format: Format,
    starting: str,
    rows_at_once: int,
    *,
    plant_by_key: bool,
) -> DataFrame | KafkaChanges:
    """A topic, or a directory that Parquet files of changes are put into."""
    if place.startswith(SCHEME):
        topic = topic_of(place)
        return from_kafka(
            spark,
            topic.servers,
            topic.name,
            format,
            starting=starting,
            plant_by_key=plant_by_key,
            rows_at_once=rows_at_once,
            **topic.options,
        )
    directory = parquet_path(spark, place)
    schema = spark.read.parquet(directory).schema
    frame = spark.readStream.schema(schema).parquet(directory)
    wanted = [name for name in ("time", "signal", "value", *OPTIONAL) if name in frame.columns]
    return frame.select(*wanted)


def sink_of(place: str) -> FindingSink:
    """Where findings go."""
    if place.startswith(SCHEME):
        topic = topic_of(place)
        return KafkaSink(topic.servers, topic.name, topic.options)
    if place.startswith(_JDBC):
        # The table is a part of its own: the address belongs to the driver.
        url, _, table = place.partition("#")
        return JdbcSink(url, table or "findings")
    return ParquetSink(place.removeprefix(PREFIX))
