"""`watch`: a stream of changes in, findings out, by the engine that watches one machine."""

from __future__ import annotations

import functools
import logging
import tempfile
import weakref
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from runglight.errors import InputError
from runglight.scale.spark import found, frames, packing
from runglight.scale.spark.counting import Counts
from runglight.scale.spark.delivery import Delivery
from runglight.scale.spark.kafka import KafkaChanges
from runglight.scale.spark.processor import READ, PartProcessor
from runglight.scale.spark.shipped_model import Model, ShippedModels, ship
from runglight.scale.spark.sinks import FindingSink, Sink, one_sink

if TYPE_CHECKING:
    from pyspark.sql import DataFrame
    from pyspark.sql.streaming import StreamingQuery

_log = logging.getLogger("runglight.scale.spark")

SECOND = 1_000_000_000
_CHECKPOINTS = "spark.sql.streaming.checkpointLocation"

SETTINGS = {
    # What is known of a part lies on the executor's disk, and its changes in the checkpoint.
    "spark.sql.streaming.stateStore.providerClass": (
        "org.apache.spark.sql.execution.streaming.state.RocksDBStateStoreProvider"
    ),
    "spark.sql.streaming.stateStore.rocksdb.changelogCheckpointing.enabled": "true",
}


def watch(
    stream: DataFrame | KafkaChanges,
    model: Model | Mapping[str, Model],
    sink: Sink | Sequence[Sink],
    *,
    checkpoint: str | None = None,
    delay_s: float = 10.0,
    quiet_s: float = 30.0,
    ahead_s: float | None = 86_400.0,
    every_s: float | None = None,
    until_here: bool = False,
    name: str = "runglight",
) -> Watching:
    """Starts watching a stream; it goes on until it is stopped.

    `stream` is what `from_kafka` gives, or a streaming DataFrame with `time` (timestamp, or bigint
    nanoseconds since 1970), `signal`, `value` and, where there are several, `plant`; with
    `partition` and `offset` rows of one time stand as they were sent. A row without a signal is a
    heartbeat: it tells that time went on.

    `model` is a model directory, a loaded model, or one for each plant by its name. It travels
    with the query: executors need not see the directory.

    `sink` is one of this package's or anything with its `write`, several of them, or the name of a
    directory for a `ParquetSink`.

    `checkpoint` is a directory that all executors see; a watch that is started again with it goes
    on where the last one ended. Without one (and without `spark.sql.streaming.checkpointLocation`)
    the next watch begins anew. The number of shuffle partitions stays the one it began with.

    Changes wait until the newest time of the stream is `delay_s` ahead of them, so that they are
    judged in order; a part that has been silent `quiet_s` beyond that is told that time went on,
    which finds its stalls. Messages `ahead_s` ahead of the executor's clock are not believed
    (None: all are). A micro-batch starts every `every_s` (None: when the last one has ended);
    with `until_here` the watch ends when all that is there now has been judged.
    """
    _check(checkpoint, delay_s, quiet_s)
    reader = stream.reader if isinstance(stream, KafkaChanges) else frames.FrameReader()
    frame = stream.frame if isinstance(stream, KafkaChanges) else frames.select(stream)
    if not frame.isStreaming:
        raise InputError(
            "watch: this DataFrame is no stream; read it with spark.readStream, or watch a log "
            "with runglight watch"
        )
    session = frame.sparkSession
    for key, setting in SETTINGS.items():
        session.conf.set(key, setting)
    ahead_ns = None if ahead_s is None else round(ahead_s * SECOND)
    place, temporary = checkpoint, None
    if checkpoint is None and not session.conf.get(_CHECKPOINTS, ""):
        # A model that is replaced goes on with it.
        temporary = tempfile.TemporaryDirectory(prefix="runglight-", ignore_cleanup_errors=True)
        place = temporary.name
        _log.warning("this watch has no checkpoint: when it is started again it begins anew")

    def start(models: ShippedModels) -> StreamingQuery:
        # Of both sides: in the executors it is what has come.
        delivery: Any = Delivery(session, models)
        packer = packing.Packer(delivery, reader, ahead_ns)
        chunks = (
            frame.mapInArrow(packer, packing.SCHEMA)
            .withWatermark("latest", f"{round(delay_s * 1000)} milliseconds")
            # Without the column Spark leaves no chunk out as late: what is late for one part
            # may be in time for another, and the watchers know.
            .select("plant", "part", *READ)
        )
        findings = chunks.groupBy("plant", "part").transformWithStateInPandas(
            PartProcessor(delivery, round(quiet_s * SECOND)), found.SCHEMA, "Append", "EventTime"
        )
        writer = (
            findings.writeStream.queryName(name)
            .outputMode("append")
            .options(**({} if place is None else {"checkpointLocation": place}))
            .foreachBatch(functools.partial(_write, one_sink(sink), counts))
        )
        if until_here:
            return writer.trigger(availableNow=True).start()
        if every_s is not None:
            return writer.trigger(processingTime=f"{round(every_s * 1000)} milliseconds").start()
        return writer.start()

    counts = Counts()
    watching = Watching(start, ship(model), counts)
    if temporary is not None:
        weakref.finalize(watching, temporary.cleanup)
    return watching


class Watching:
    """A stream that is being watched."""

    def __init__(self, start: Any, models: ShippedModels, counts: Counts) -> None:
        self._start = start
        self._models = models
        self.counts = counts
        self.query: StreamingQuery = start(models)

    def replace_model(self, model: Model | Mapping[str, Model]) -> bool:
        """Goes on with another model; False where it is the same one.

        The micro-batch under way is broken off and run again, all of it with the new model. Each
        part starts afresh, says so in a notice, and judges every change that had waited.
        """
        models = ship(model)
        if models == self._models:
            return False
        self.stop()
        self._models = models
        self.query = self._start(models)
        return True

    def wait(self, seconds: float | None = None) -> bool:
        """Waits for the end, or some seconds; True where it has ended. Raises what ended it."""
        if seconds is None:
            self.query.awaitTermination()
            return True
        return bool(self.query.awaitTermination(seconds))

    def stop(self) -> None:
        """Ends the watch; what was not judged yet is judged when it is started again."""
        self.query.stop()


def _write(sink: FindingSink, counts: Counts, findings: DataFrame, batch: int) -> None:
    # Kept, so that the monitors run once however often a sink looks at the findings.
    findings.persist()
    try:
        if counts.add(findings):
            sink.write(findings, batch)
    finally:
        findings.unpersist()


def _check(checkpoint: str | None, delay_s: float, quiet_s: float) -> None:
    if checkpoint is not None and not checkpoint:
        raise InputError("watch: checkpoint is empty; name a directory that all executors see")
    for option, seconds in (("delay_s", delay_s), ("quiet_s", quiet_s)):
        if not seconds >= 0:
            raise InputError(f"watch: {option} is {seconds}; give seconds, 0 or more")
