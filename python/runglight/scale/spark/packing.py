"""The first stage: rows as they come are read and packed into chunks, one per part and task.

Spark then moves a few large values in place of millions of small rows.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa

from runglight.scale.spark import aside, chunk
from runglight.scale.spark.changes import Changes
from runglight.scale.wire import GAP

if TYPE_CHECKING:
    from runglight.scale.spark.shipped_model import Models

SCHEMA = (
    "plant string, part string, latest timestamp, partition int, offset bigint, rows binary, "
    "opens_ns bigint, opens_image boolean"
)
_ARROW = pa.schema(
    [
        ("plant", pa.string()),
        ("part", pa.string()),
        ("latest", pa.timestamp("us", "UTC")),
        ("partition", pa.int32()),
        ("offset", pa.int64()),
        ("rows", pa.binary()),
        ("opens_ns", pa.int64()),
        ("opens_image", pa.bool_()),
    ]
)
ROWS_AT_ONCE = 1 << 18
"""Rows that a task holds before it packs them."""

EVERY_PART = -1

Read = Callable[[Any], Changes]


class Packer:
    """Runs in the executors: a task's record batches in, record batches of chunks out."""

    def __init__(self, models: Models, read: Read, ahead_ns: int | None) -> None:
        self._models = models
        self._read = read
        self._ahead_ns = ahead_ns
        self._part_of: dict[str, dict[str, int]] = {}

    def __call__(self, batches: Iterable[pa.RecordBatch]) -> Iterator[pa.RecordBatch]:
        """Packs what one task reads."""
        held: list[Changes] = []
        rows = 0
        for batch in batches:
            if not len(batch):
                continue
            held.append(self._within_reach(self._read(batch)))
            rows += len(held[-1])
            if rows >= ROWS_AT_ONCE:
                yield from self._packed(held)
                held, rows = [], 0
        if held:
            yield from self._packed(held)

    def _within_reach(self, changes: Changes) -> Changes:
        # One time stamp of next year would make everything until then late.
        if self._ahead_ns is None or not len(changes):
            return changes
        limit_ns = time.time_ns() + self._ahead_ns
        within = changes.time_ns <= limit_ns
        if within.all():
            return changes
        first = f"has a time that lies ahead: {changes.time_ns[int(np.argmin(within))]} ns"
        return changes.only(within).blaming(int((~within).sum()), first)

    def _packed(self, held: list[Changes]) -> Iterator[pa.RecordBatch]:
        rows = [self._aside(held)]
        heard = [each for each in held if len(each)]
        if heard:
            rows += self._chunks(heard)
        columns = zip(*rows, strict=True)
        yield pa.RecordBatch.from_arrays(
            [pa.array(column, field.type) for column, field in zip(columns, _ARROW, strict=True)],
            schema=_ARROW,
        )

    def _aside(self, held: list[Changes]) -> tuple[Any, ...]:
        newest_ns = max((int(each.time_ns.max()) for each in held if len(each)), default=0)
        packed = aside.packed(
            aside.Aside(
                newest_ns,
                sum(each.unreadable for each in held),
                next((each.first for each in held if each.first), ""),
            )
        )
        partition = int(held[0].partition[0]) if len(held[0]) else 0
        return ("", aside.PART, newest_ns // 1000, partition, held[0].offset, packed, 0, False)

    def _chunks(self, held: list[Changes]) -> Iterator[tuple[Any, ...]]:
        plants = pa.chunked_array([each.plant for each in held]).unify_dictionaries()
        signals = pa.chunked_array([each.signal for each in held]).unify_dictionaries()
        plant, signal = plants.combine_chunks(), signals.combine_chunks()
        plant, signal = _single(plant), _single(signal)
        time_ns = np.concatenate([each.time_ns for each in held])
        value = np.concatenate([each.value for each in held])
        partition = np.concatenate([each.partition for each in held])
        offset = held[0].offset

        beating = signal.indices.is_null().to_numpy(zero_copy_only=False)
        index = signal.indices.fill_null(0).to_numpy(zero_copy_only=False)
        named = plant.indices.fill_null(0).to_numpy(zero_copy_only=False)
        for number, name in enumerate(plant.dictionary.to_pylist()):
            here = (named == number) & ~beating
            if not here.any():
                continue
            parts, part_of = self._parts(name, signal.dictionary)
            first_ns = time_ns[here].min()
            opening = int(first_ns), bool((value[here & (time_ns == first_ns)] == 0).any())
            gap = here & (part_of[index] == EVERY_PART)
            gaps = np.flatnonzero(gap)
            of_row = np.where(here & ~gap, part_of[index], len(parts))
            order = np.argsort(of_row, kind="stable")
            bounds = np.searchsorted(of_row[order], np.arange(len(parts) + 1))
            for position, part in enumerate(parts):
                chosen = order[bounds[position] : bounds[position + 1]]
                if len(gaps):
                    chosen = np.sort(np.concatenate([chosen, gaps]))
                if not len(chosen):
                    # It has to know when the plant's rows begin all the same.
                    yield name, part, int(first_ns) // 1000, 0, offset, None, *opening
                    continue
                table = chunk.table_of(
                    time_ns[chosen],
                    signal.take(pa.array(chosen)),
                    value[chosen],
                    partition[chosen],
                )
                latest_us = int(time_ns[chosen].max()) // 1000
                came_by = int(partition[chosen[0]])
                yield name, part, latest_us, came_by, offset, chunk.pack(table), *opening

    def _parts(self, plant: str, signals: Any) -> tuple[tuple[str, ...], Any]:
        model = self._models.of(plant)
        if model is None:
            # Its processor says so.
            return ("",), np.zeros(len(signals), np.int64)
        parts = model.parts()
        known = self._part_of.setdefault(plant, {GAP: EVERY_PART})
        names = signals.to_pylist()
        strangers = [name for name in names if name not in known]
        known.update(zip(strangers, parts.of_signals(strangers), strict=True))
        return parts.names, np.array([known[name] for name in names], np.int64)


def _single(array: Any) -> Any:
    if isinstance(array, pa.ChunkedArray):
        return array.chunk(0)
    return array
