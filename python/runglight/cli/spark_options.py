"""What both commands of `runglight spark` take."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from runglight.errors import InputError

if TYPE_CHECKING:
    from contextlib import AbstractContextManager

    from pyspark.sql import SparkSession


@Parameter(name="*", group="Spark")
@dataclass(frozen=True, kw_only=True)
class SparkOptions:
    """Which Spark; `spark-submit` has said so already."""

    master: str | None = None
    "Where Spark runs (default: what `spark-submit` says, else `local[*]`: this computer)."
    set_: Annotated[tuple[str, ...], Parameter(name="--set")] = ()
    "`KEY=VALUE`: a setting of Spark; repeat it for several."

    def session(self) -> AbstractContextManager[SparkSession]:
        """The session; raises InputError where there is none."""
        from runglight.scale.spark.session import spark_session  # noqa: PLC0415

        return spark_session(self.master, dict(map(_setting, self.set_)))


def _setting(text: str) -> tuple[str, str]:
    key, separator, value = text.partition("=")
    if not separator or not key:
        raise InputError(f"--set {text}: write KEY=VALUE, spark.sql.shuffle.partitions=8")
    return key, value
