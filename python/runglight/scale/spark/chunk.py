"""Changes of one part on their way through Spark: many rows in one binary value.

A row each would cost Spark some microseconds in every stage; a chunk of rows costs it that once.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa

if TYPE_CHECKING:
    from collections.abc import Iterable

TIME = pa.timestamp("ns", "UTC")
SIGNAL = pa.dictionary(pa.int32(), pa.string())
SCHEMA = pa.schema(
    [("time", TIME), ("signal", SIGNAL), ("value", pa.int64()), ("partition", pa.int32())]
)
"""`partition` is the partition of the topic a row came by; it orders rows of one time."""


def table_of(time_ns: Any, signal: Any, value: Any, partition: Any) -> pa.Table:
    """Rows from numpy arrays (int64, int64, int32) and a dictionary array of names."""
    return pa.Table.from_arrays(
        [
            pa.array(time_ns, pa.int64()).view(TIME),
            signal,
            pa.array(value, pa.int64()),
            pa.array(partition, pa.int32()),
        ],
        schema=SCHEMA,
    )


def nothing() -> pa.Table:
    """No rows."""
    return SCHEMA.empty_table()


def pack(table: pa.Table) -> bytes:
    """The rows as an Arrow stream, with no more names than they use."""
    sink = pa.BufferOutputStream()
    with pa.ipc.new_stream(sink, SCHEMA) as writer:
        writer.write_table(_compact(table))
    packed: bytes = sink.getvalue().to_pybytes()
    return packed


def unpack(chunks: Iterable[bytes]) -> pa.Table:
    """All rows of some chunks, one after another."""
    tables = [pa.ipc.open_stream(chunk).read_all() for chunk in chunks]
    return pa.concat_tables(tables) if tables else nothing()


def times_ns(table: pa.Table) -> Any:
    """Times as an int64 array: nanoseconds since 1970."""
    return table.column("time").combine_chunks().view(pa.int64()).to_numpy(zero_copy_only=False)


def in_order(table: pa.Table) -> pa.Table:
    """The rows by time; those of one time by the partition they came by, then as they came."""
    # As one array: rows are taken by number, from one dictionary.
    table = table.unify_dictionaries().combine_chunks()
    time_ns = times_ns(table)
    partition = table.column("partition").to_numpy()
    same_time = time_ns[1:] == time_ns[:-1]
    if not (
        np.any(time_ns[1:] < time_ns[:-1]) or np.any(same_time & (partition[1:] < partition[:-1]))
    ):
        return table
    return table.take(pa.array(np.lexsort((partition, time_ns))))


def _compact(table: pa.Table) -> pa.Table:
    signal = table.column("signal").unify_dictionaries().combine_chunks()
    if isinstance(signal, pa.ChunkedArray):
        signal = signal.chunk(0) if signal.num_chunks else pa.array([], SIGNAL)
    index = signal.indices.to_numpy(zero_copy_only=False)
    used = np.flatnonzero(np.bincount(index, minlength=len(signal.dictionary)))
    if len(used) < len(signal.dictionary):
        renumbered = np.zeros(len(signal.dictionary), np.int32)
        renumbered[used] = np.arange(len(used), dtype=np.int32)
        signal = pa.DictionaryArray.from_arrays(
            pa.array(renumbered[index], pa.int32()), signal.dictionary.take(pa.array(used))
        )
    return table.set_column(1, SCHEMA.field("signal"), signal)
