"""A session of Spark, or one sentence why there is none."""

from __future__ import annotations

import importlib.util
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING

from runglight.errors import InputError

if TYPE_CHECKING:
    from pyspark.sql import SparkSession

CONNECTOR = "org.apache.spark:spark-sql-kafka-0-10_2.13"
_MODULES = ("pyspark", "pandas", "pyarrow", "google.protobuf")


@contextmanager
def spark_session(
    master: str | None = None, settings: Mapping[str, str] | None = None
) -> Iterator[SparkSession]:
    """The session `spark-submit` set up, or one of its own; what Spark raises is one sentence."""
    check_installed()
    from pyspark.errors import PySparkException  # noqa: PLC0415
    from pyspark.sql import SparkSession  # noqa: PLC0415

    builder = SparkSession.builder.appName("runglight")
    if master is not None:
        builder = builder.master(master)
    for key, value in {"spark.sql.session.timeZone": "UTC", **(settings or {})}.items():
        builder = builder.config(key, value)
    try:
        session = builder.getOrCreate()
    except PySparkException as error:
        raise InputError(
            f"Spark does not start ({_first_line(error)}); it needs Java 17: is java on the PATH, "
            "or JAVA_HOME set?"
        ) from None
    _fewer_partitions(session)
    try:
        yield session
    except PySparkException as error:
        raise InputError(_sentence(error)) from error
    finally:
        session.stop()


def _fewer_partitions(session: SparkSession) -> None:
    # 200 where nobody said otherwise, each a task with a Python worker in every micro-batch. A
    # checkpoint keeps the number it began with.
    key = "spark.sql.shuffle.partitions"
    if session.sparkContext.getConf().get(key) is None:
        session.conf.set(key, str(max(2, session.sparkContext.defaultParallelism)))


def check_installed() -> None:
    """Raises InputError where the extra is missing."""
    for module in _MODULES:
        try:
            found = importlib.util.find_spec(module)
        except ModuleNotFoundError:
            found = None
        if found is None:
            raise InputError(
                f'runglight spark needs {module}: pip install "runglight[spark]" (about 0.5 GB)'
            )


def _sentence(error: Exception) -> str:
    text = _first_line(error)
    if "data source: kafka" in text.replace("`", ""):
        from pyspark import __version__  # noqa: PLC0415

        return (
            "Spark has no Kafka connector here; give spark-submit --packages "
            f"{CONNECTOR}:{__version__} (or --set spark.jars.packages=…)"
        )
    return f"Spark ended: {text}"


def _first_line(error: Exception) -> str:
    lines = [line for line in str(error).splitlines() if line.strip()]
    return lines[0].strip() if lines else type(error).__name__
