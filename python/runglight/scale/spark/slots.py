"""Groups over partitions: as even as can be, each partition by itself."""

from __future__ import annotations

from collections.abc import Sequence
from heapq import heapify, heapreplace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pyspark.sql import SparkSession

CANDIDATES = 40
"""Numbers tried for each partition, to find one that Spark puts there."""


def slots_of(rows: Sequence[int], partitions: int) -> list[int]:
    """The partition of each group, given its rows: the largest first, to the emptiest."""
    filled = [(0, slot) for slot in range(partitions)]
    heapify(filled)
    slots = [0] * len(rows)
    for group in sorted(range(len(rows)), key=lambda group: -rows[group]):
        load, slot = filled[0]
        slots[group] = slot
        heapreplace(filled, (load + rows[group], slot))
    return slots


def keys_of(session: SparkSession, partitions: int) -> list[int]:
    """For each partition a number that `repartition(partitions, column)` sends there.

    Spark's partitioner is `pmod(hash(column), partitions)`; hashing the partitions' own numbers
    would leave some empty and put several groups into others.
    """
    from pyspark.sql import functions as F  # noqa: N812, PLC0415

    number = F.col("id").cast("int")
    rows = (
        session.range(CANDIDATES * partitions)
        .groupBy(F.pmod(F.hash(number), F.lit(partitions)).alias("slot"))
        .agg(F.min(number).alias("key"))
        .collect()
    )
    found = {int(row["slot"]): int(row["key"]) for row in rows}
    return [found.get(slot, slot) for slot in range(partitions)]
