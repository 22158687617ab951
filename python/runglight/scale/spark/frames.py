"""A DataFrame of changes, whatever it was made of, read in the executors."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa

from runglight.errors import InputError
from runglight.scale.spark.changes import Changes, everywhere, names

if TYPE_CHECKING:
    from pyspark.sql import DataFrame

NEEDED = ("time", "signal", "value")
OPTIONAL = ("plant", "partition", "offset")
_TIMES = ("timestamp", "timestamp_ntz", "bigint")
_VALUES = ("bigint", "int", "smallint", "tinyint", "boolean")


def select(frame: DataFrame) -> DataFrame:
    """The columns that are read; raises InputError where one is missing or of another type."""
    types = dict(frame.dtypes)
    for name in NEEDED:
        if name not in types:
            raise InputError(
                f"watch: the stream has no column {name} (it has {', '.join(frame.columns)}); "
                "rename one: stream.withColumnRenamed(…)"
            )
    if types["time"] not in _TIMES:
        raise InputError(
            f"watch: column time is {types['time']}; make it a timestamp, or bigint nanoseconds "
            "since 1970 where microseconds are too coarse"
        )
    if types["value"] not in _VALUES:
        raise InputError(
            f"watch: column value is {types['value']}; cast it to bigint (booleans are 0 and 1)"
        )
    return frame.select(*NEEDED, *(name for name in OPTIONAL if name in types))


@dataclass(frozen=True)
class FrameReader:
    """Reads record batches of the columns of `select`."""

    def __call__(self, batch: pa.RecordBatch) -> Changes:
        """Changes of one record batch."""
        columns = dict(zip(batch.schema.names, batch.columns, strict=True))
        beating = columns["signal"].is_null()
        said = columns["value"].is_valid()
        wanted = _flags(columns["time"].is_valid()) & (_flags(said) | _flags(beating))
        left_out = len(batch) - int(wanted.sum())
        if left_out:
            chosen = pa.array(wanted)
            columns = {name: column.filter(chosen) for name, column in columns.items()}
        rows = len(columns["time"])
        changes = Changes(
            _nanoseconds(columns["time"]),
            names(columns["signal"].cast(pa.string())),
            columns["value"].cast(pa.int64()).fill_null(0).to_numpy(zero_copy_only=False),
            _plants(columns.get("plant"), rows),
            _partitions(columns.get("partition"), rows),
            _first(columns.get("offset"), rows),
        )
        return changes.blaming(left_out, "has no time or no value") if left_out else changes


def _flags(booleans: Any) -> Any:
    return booleans.to_numpy(zero_copy_only=False)


def _nanoseconds(time: Any) -> Any:
    if pa.types.is_timestamp(time.type):
        time = time.cast(pa.timestamp("ns", time.type.tz)).cast(pa.int64())
    return time.to_numpy(zero_copy_only=False)


def _plants(plant: Any, rows: int) -> Any:
    return everywhere("", rows) if plant is None else names(plant.cast(pa.string()).fill_null(""))


def _partitions(partition: Any, rows: int) -> Any:
    if partition is None:
        return np.zeros(rows, np.int32)
    return partition.cast(pa.int32()).fill_null(0).to_numpy(zero_copy_only=False)


def _first(offset: Any, rows: int) -> int:
    if offset is not None:
        return int(offset[0].as_py() or 0) if rows else 0
    return _task_offset()


_counted = 0


def _task_offset() -> int:
    # Without offsets, rows of one time stand as the tasks that read them are numbered.
    global _counted  # noqa: PLW0603
    from pyspark import TaskContext  # noqa: PLC0415

    task = TaskContext.get()
    _counted += 1
    return ((0 if task is None else task.partitionId()) << 40) + _counted
