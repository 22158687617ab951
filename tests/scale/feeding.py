"""Logs as streams: cut, disordered, and judged by one machine to compare with."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from runglight.log.changelog import Log
from runglight.model import NominalModel, learn
from runglight.plants.bodyshop import simulate_bodyshop

SECOND = 1_000_000_000
ROWS = "time bigint, signal string, value bigint, plant string, partition int, offset bigint"


def rows_of(log: Log, plant: str = "", partition: int = 0) -> pa.Table:
    """The log as rows of `ROWS`."""
    table = pa.table(log)
    count = len(table)
    return pa.table(
        {
            "time": table["time"].cast(pa.int64()),
            "signal": table["signal"].cast(pa.string()),
            "value": table["value"],
            "plant": pa.array([plant] * count, pa.string()),
            "partition": pa.array(np.full(count, partition, np.int32)),
            "offset": pa.array(np.arange(count, dtype=np.int64)),
        }
    )


def heartbeat(time_ns: int) -> pa.Table:
    """A row that tells the time and nothing else."""
    return pa.table(
        {
            "time": pa.array([time_ns], pa.int64()),
            "signal": pa.array([None], pa.string()),
            "value": pa.array([0], pa.int64()),
            "plant": pa.array([""], pa.string()),
            "partition": pa.array([0], pa.int32()),
            "offset": pa.array([0], pa.int64()),
        }
    )


def cut(rows: pa.Table, pieces: int) -> list[pa.Table]:
    """The rows in some pieces of about one size."""
    bounds = [len(rows) * piece // pieces for piece in range(pieces + 1)]
    return [rows.slice(start, end - start) for start, end in pairwise(bounds)]


def disordered(rows: pa.Table, by_s: float, seed: int = 7) -> pa.Table:
    """The rows as they come where each is under way for up to some seconds."""
    time_ns = rows["time"].to_numpy()
    random = np.random.default_rng(seed)
    # Rows of one time come together: nothing tells their order but the order they came in.
    _, of_time = np.unique(time_ns, return_inverse=True)
    delay = random.uniform(0, by_s * SECOND, of_time.max() + 1)
    return rows.take(pa.array(np.argsort(time_ns + delay[of_time], kind="stable")))


def write(directory: Path, pieces: Sequence[pa.Table], first: int = 0) -> None:
    """Files that a stream reads one after another."""
    directory.mkdir(parents=True, exist_ok=True)
    for number, piece in enumerate(pieces, first):
        temporary = directory / f".{number:06d}"
        pq.write_table(piece, temporary)
        # Spark takes files by their time.
        os.utime(temporary, (1_000_000_000 + number, 1_000_000_000 + number))
        temporary.rename(directory / f"{number:06d}.parquet")


def stream(spark: Any, directory: Path, files_at_once: int = 1) -> Any:
    """The files of a directory, so many in a micro-batch."""
    reader = spark.readStream.schema(ROWS).option("maxFilesPerTrigger", str(files_at_once))
    return reader.parquet(str(directory))


def by_one_machine(model: NominalModel, log: Log, until_ns: int) -> list[str]:
    """What one machine finds in the log, and in the silence after it, in order of the lines."""
    monitor = model.monitor()
    lines = monitor.observe(log).json_lines() + monitor.advance(until_ns - 1).json_lines()
    return sorted(lines)


def last_ns(log: Log) -> int:
    """Time of the last row."""
    end = log.engine.end_ns
    assert end is not None
    return end


def found(spark: Any, directory: Path) -> list[str]:
    """The findings in a Parquet sink, in order of the lines."""
    frames = spark.read.parquet(str(directory))
    return sorted(row["finding"] for row in frames.select("finding").collect())


def each_once(lines: Iterable[str]) -> bool:
    """Whether no finding is there twice by id and state."""
    keys = [(finding["id"], finding["state"]) for finding in map(json.loads, lines)]
    return len(keys) == len(set(keys))


def body_shop(
    size: str = "tiny",
    learn_events: int = 38_000,
    watch_events: int = 12_000,
    broken: float = 0.002,
) -> tuple[NominalModel, Log]:
    """The model of a body shop, and a log of it in which that share of the changes is missing."""
    run = simulate_bodyshop(size, 1, learn_events, watch_events)
    learned, watched = (
        Log.from_columns(part.time_ns, part.signal_index, part.value, part.signals)
        for part in (run.learn, run.watch)
    )
    kept = np.random.default_rng(3).random(len(watched)) >= broken
    time_ns, signal_index, value = (column[kept] for column in watched.columns())
    return learn(learned), Log.from_columns(time_ns, signal_index, value, watched.signals)
