"""Learning in a cluster: the model that `runglight.learn` would make of the same log."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from runglight import _engine
from runglight.configuration import Parameters
from runglight.errors import InputError
from runglight.log.symbols import read_symbols
from runglight.model import NominalModel
from runglight.moments import nanoseconds
from runglight.scale.spark.columns import changes
from runglight.scale.spark.lessons import (
    LEARNED,
    SURVEYED,
    LearnGroups,
    MergeSurveys,
    Survey,
)
from runglight.scale.spark.session import check_installed
from runglight.scale.spark.slots import keys_of, slots_of
from runglight.strictly import convert

if TYPE_CHECKING:
    from datetime import datetime
    from os import PathLike

    from pyspark.sql import DataFrame

MERGED_BY = 8
"""Tasks that merge the surveys of all partitions."""


def learn(
    df: DataFrame,
    symbols: str | PathLike[str] | None = None,
    *,
    time: str | None = None,
    signal: str | None = None,
    value: str | None = None,
    order: str | None = None,
    gaps: Sequence[tuple[datetime | int, datetime | int]] = (),
    source: Sequence[str] = (),
    **parameters: Any,
) -> NominalModel:
    """Learns from one fault-free log, whatever its DataFrame was made of and in whatever order.

    `symbols` and `parameters` are those of `runglight.learn`, and so is the model: rule by rule
    what one machine learns of the same rows.

    The columns are found by their names as in any log, or named: `time` (a timestamp, which Spark
    keeps to the microsecond, or bigint nanoseconds since 1970), `signal` (text) and `value` (whole
    numbers or booleans). `order` names a column of whole numbers that says in which order rows of
    one time happened, such as a Kafka offset or a row number. Without it, rows of one time are
    taken by signal name, then value: as one machine would learn of a log sorted by time, signal
    and value. `gaps` are stretches (aware datetimes, or nanoseconds since 1970; in time order) in
    which nothing was recorded; `source` is written into the model.

    The DataFrame is read twice: first every partition is surveyed, then the rows of each group are
    brought together and learned in one task, which holds one group's rows at a time. So no more
    tasks work at a time than there are groups (nor than `spark.sql.shuffle.partitions`), and the
    largest group takes the longest; cache a DataFrame that is dear to make.

    Raises InputError for a missing column, for rows without a time, signal or value, and for what
    `runglight.learn` refuses.
    """
    check_installed()
    settings = convert(parameters, Parameters, "learn")
    table = None if symbols is None else read_symbols(Path(symbols))
    rows = changes(df, time, signal, value, order)
    silent = tuple((nanoseconds(start), nanoseconds(end)) for start, end in gaps)
    context = _engine.LearningContext.of(_survey(rows, silent), table, settings.to_json())
    return NominalModel(context.merge(_lessons(rows, context), list(source)))


def _survey(rows: DataFrame, gaps: tuple[tuple[int, int], ...]) -> _engine.LogSurvey:
    """The survey of all rows; raises InputError where some cannot be read."""
    surveys = rows.mapInArrow(Survey(gaps), SURVEYED).repartition(MERGED_BY)
    survey = _engine.LogSurvey(gaps)
    unreadable, first = 0, None
    for merged in surveys.mapInArrow(MergeSurveys(gaps), SURVEYED).collect():
        survey.merge(bytes(merged["survey"]))
        unreadable += merged["unreadable"]
        first = first or merged["first"]
    if unreadable:
        raise InputError(
            f"learn: {unreadable} of {unreadable + len(survey)} rows cannot be read; one has "
            f"{first}; leave them out: df.dropna(), or cast their column"
        )
    return survey


def _lessons(rows: DataFrame, context: _engine.LearningContext) -> list[bytes]:
    """What each group teaches."""
    import pyarrow as pa  # noqa: PLC0415
    from pyspark.sql import functions as F  # noqa: N812, PLC0415

    session = rows.sparkSession
    at_most = int(session.conf.get("spark.sql.shuffle.partitions") or 1)
    partitions = min(len(context.groups), at_most)
    slots = slots_of(context.rows_of_groups, partitions)
    keys = keys_of(session, partitions)
    names = [name for name, _ in context.signals]
    groups = [group for _, group in context.signals]
    by_name = {name: rank for rank, name in enumerate(sorted(names))}
    signals = session.createDataFrame(
        pa.table(
            {
                "signal": pa.array(names),
                "number": pa.array(range(len(names)), pa.int32()),
                "group": pa.array(groups, pa.int32()),
                "slot": pa.array([keys[slots[group]] for group in groups], pa.int32()),
                "rank": pa.array([by_name[name] for name in names], pa.int32()),
            }
        )
    )
    ordered = "place" in rows.columns
    among = ["place"] if ordered else ["rank", "value"]
    columns = ["group", "time", "number", "value", *(["place"] if ordered else [])]
    learned = (
        rows.join(F.broadcast(signals), "signal")
        .repartition(partitions, "slot")
        .sortWithinPartitions("group", "time", *among)
        .select(*columns)
        .mapInArrow(LearnGroups(context.state()), LEARNED)
    )
    return [bytes(row["lesson"]) for row in learned.collect()]
