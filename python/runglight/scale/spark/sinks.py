"""Where findings go. A sink writes the findings of one micro-batch, and may be asked to again.

After a crash Spark runs the last micro-batch once more, under the same number. `ParquetSink` then
replaces what it wrote: exactly once in effect. `KafkaSink` and `JdbcSink` write again: at least
once, and a double has the `plant`, `id` and `state` of a row that is there.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from typing import TYPE_CHECKING, Protocol, TypeAlias

if TYPE_CHECKING:
    from pyspark.sql import DataFrame


class FindingSink(Protocol):
    """Takes the findings of one micro-batch: columns of `found.SCHEMA`, never none."""

    def write(self, findings: DataFrame, batch: int) -> None:
        """Writes them; the same batch may come again, with the same findings."""


@dataclass(frozen=True)
class ParquetSink:
    """A directory with one directory of Parquet files per micro-batch, on any file system of Spark.

    It is written under a temporary name and renamed; where renaming is not one step (object
    stores), a reader may see part of the newest batch.
    """

    directory: str

    def write(self, findings: DataFrame, batch: int) -> None:
        """Replaces the batch."""
        # A partition column to Spark, polars and DuckDB; what begins with a dot none of them reads.
        name = f"batch={batch}"
        temporary = f"{self.directory}/.{name}.part"
        findings.coalesce(1).write.mode("overwrite").parquet(temporary)
        session = findings.sparkSession
        java = session._jvm
        path = java.org.apache.hadoop.fs.Path
        source, target = path(temporary), path(f"{self.directory}/{name}")
        system = source.getFileSystem(session._jsparkSession.sessionState().newHadoopConf())
        system.delete(target, True)
        if not system.rename(source, target):
            raise OSError(f"{target}: could not be renamed from {temporary}")


@dataclass(frozen=True)
class KafkaSink:
    """A topic: the finding's JSON as the value, the plant as the key."""

    servers: str | Sequence[str]
    topic: str
    options: Mapping[str, str] = field(default_factory=dict)
    """Of Spark's Kafka sink: `kafka.security.protocol`, …"""

    def write(self, findings: DataFrame, batch: int) -> None:
        """Sends the batch."""
        servers = self.servers if isinstance(self.servers, str) else ",".join(self.servers)
        (
            findings.selectExpr("plant AS key", "finding AS value")
            .write.format("kafka")
            .options(**{"kafka.bootstrap.servers": servers, "topic": self.topic, **self.options})
            .save()
        )


@dataclass(frozen=True)
class JdbcSink:
    """A table of a database with a JDBC driver; made when it is not there."""

    url: str
    table: str = "findings"
    options: Mapping[str, str] = field(default_factory=dict)
    """Of Spark's JDBC sink: `user`, `password`, `driver`, …"""

    def write(self, findings: DataFrame, batch: int) -> None:
        """Adds the batch."""
        (
            findings.write.format("jdbc")
            .mode("append")
            .options(**{"url": self.url, "dbtable": self.table, **self.options})
            .save()
        )


@dataclass(frozen=True)
class SeveralSinks:
    """One after another; where one fails, the batch comes again to all."""

    sinks: Sequence[FindingSink]

    def write(self, findings: DataFrame, batch: int) -> None:
        """Writes to each."""
        for sink in self.sinks:
            sink.write(findings, batch)


Sink: TypeAlias = "FindingSink | str | PathLike[str]"
"""A sink, or the directory of a `ParquetSink`."""


def one_sink(sink: Sink | Sequence[Sink]) -> FindingSink:
    """A sink, or several as one."""
    if isinstance(sink, str | PathLike):
        return ParquetSink(os.fspath(sink))
    if isinstance(sink, Sequence):
        return SeveralSinks([one_sink(each) for each in sink])
    return sink
