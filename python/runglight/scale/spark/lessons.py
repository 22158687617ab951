"""What runs in the executors while a model is learned. Record batches in, bytes out."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from runglight import _engine

if TYPE_CHECKING:
    import pyarrow as pa

SURVEYED = "survey binary, unreadable bigint, first string"
LEARNED = "lesson binary"


def _rows(schema: str, rows: Iterable[tuple[Any, ...]]) -> pa.RecordBatch:
    import pyarrow as pa  # noqa: PLC0415

    types = {"binary": pa.binary(), "bigint": pa.int64(), "string": pa.string()}
    fields = [field.split() for field in schema.split(", ")]
    columns = zip(*rows, strict=True)
    return pa.RecordBatch.from_arrays(
        [
            pa.array(list(column), types[kind])
            for column, (_, kind) in zip(columns, fields, strict=True)
        ],
        names=[name for name, _ in fields],
    )


@dataclass(frozen=True)
class Survey:
    """Surveys the rows of a partition, and counts those that lack something."""

    gaps: tuple[tuple[int, int], ...]

    def __call__(self, batches: Iterator[pa.RecordBatch]) -> Iterator[pa.RecordBatch]:
        """One row for the partition."""
        survey = _engine.LogSurvey(self.gaps)
        unreadable, first = 0, None
        for batch in batches:
            whole = batch.drop_null() if any(c.null_count for c in batch.columns) else batch
            if len(whole) < len(batch):
                unreadable += len(batch) - len(whole)
                first = first or _first_unreadable(batch)
            survey.add(whole)
        yield _rows(SURVEYED, [(survey.state(), unreadable, first)])


@dataclass(frozen=True)
class MergeSurveys:
    """Makes one survey of those of several partitions."""

    gaps: tuple[tuple[int, int], ...]

    def __call__(self, batches: Iterator[pa.RecordBatch]) -> Iterator[pa.RecordBatch]:
        """One row for the partition."""
        survey = _engine.LogSurvey(self.gaps)
        unreadable, first = 0, None
        for batch in batches:
            for row in batch.to_pylist():
                survey.merge(row["survey"])
                unreadable += row["unreadable"]
                first = first or row["first"]
        yield _rows(SURVEYED, [(survey.state(), unreadable, first)])


@dataclass(frozen=True)
class LearnGroups:
    """Learns one group after another; holds the rows of one."""

    context: bytes

    def __call__(self, batches: Iterator[pa.RecordBatch]) -> Iterator[pa.RecordBatch]:
        """One row for each group; rows come sorted by group, time and place."""
        learner = _engine.LearningContext.restore(self.context).learner()
        for batch in batches:
            columns = {
                name: column.to_numpy()
                for name, column in zip(batch.schema.names, batch.columns, strict=True)
            }
            lessons = learner.add(
                columns["group"],
                columns["time"],
                columns["number"],
                columns["value"],
                columns.get("place"),
            )
            if lessons:
                yield _rows(LEARNED, [(lesson,) for lesson in lessons])
        last = learner.finish()
        if last is not None:
            yield _rows(LEARNED, [(last,)])


def _first_unreadable(batch: pa.RecordBatch) -> str:
    for row in batch.to_pylist():
        missing = [name for name, cell in row.items() if cell is None]
        if missing:
            known = ", ".join(f"{name} {cell}" for name, cell in row.items() if cell is not None)
            return f"no {' and no '.join(missing)} ({known or 'nothing'})"
    return ""
