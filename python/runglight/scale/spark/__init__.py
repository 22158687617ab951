"""runglight on Spark: a plant's monitors as the keyed state of a stream.

    from runglight.scale.spark import ParquetSink, from_kafka, watch

    changes = from_kafka(spark, "broker:9092", "line-1")
    watching = watch(changes, "line.model", ParquetSink("findings"), checkpoint="checkpoint")
    watching.wait()

Needs `pip install "runglight[spark]"` and Java 17; nothing of it is loaded before it is used.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from runglight.scale.spark.kafka import KafkaChanges, from_kafka
    from runglight.scale.spark.learning import learn
    from runglight.scale.spark.sinks import FindingSink, JdbcSink, KafkaSink, ParquetSink
    from runglight.scale.spark.watching import Watching, watch

__all__ = [
    "FindingSink",
    "JdbcSink",
    "KafkaChanges",
    "KafkaSink",
    "ParquetSink",
    "Watching",
    "from_kafka",
    "learn",
    "watch",
]

_HOMES = {
    "FindingSink": "runglight.scale.spark.sinks",
    "JdbcSink": "runglight.scale.spark.sinks",
    "KafkaChanges": "runglight.scale.spark.kafka",
    "KafkaSink": "runglight.scale.spark.sinks",
    "ParquetSink": "runglight.scale.spark.sinks",
    "Watching": "runglight.scale.spark.watching",
    "from_kafka": "runglight.scale.spark.kafka",
    "learn": "runglight.scale.spark.learning",
    "watch": "runglight.scale.spark.watching",
}


def __getattr__(name: str) -> object:
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module 'runglight.scale.spark' has no attribute {name!r}")
    return getattr(import_module(home), name)
