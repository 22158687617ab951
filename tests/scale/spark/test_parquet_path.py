"""A path is looked for before Spark reads it: one sentence instead of a Java stack."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from runglight.errors import InputError
from tests.scale.killing import PATIENCE_S

if TYPE_CHECKING:
    from pyspark.sql import SparkSession


def parquet_path(spark: SparkSession, place: str) -> str:
    """Loaded when Spark is there."""
    from runglight.scale.spark.parquet_path import parquet_path as looked_up  # noqa: PLC0415

    return looked_up(spark, place)


@pytest.fixture
def days(tmp_path: Path) -> Path:
    """Two days of a log, and what Spark leaves behind."""
    for day in ("1", "2"):
        (tmp_path / f"day={day}").mkdir()
        pq.write_table(pa.table({"value": [1]}), tmp_path / f"day={day}" / "part.parquet")
    (tmp_path / "day=1" / "_SUCCESS").touch()
    return tmp_path


def test_what_is_there_is_read(spark: SparkSession, days: Path) -> None:
    for place in ("", "/day=1", "/day=*", "/day=1/part.parquet", "/day=1/*", "/day={1,2}"):
        path = f"{days}{place}"
        for written in (path, f"parquet:{path}", f"file://{path}"):
            there = parquet_path(spark, written)
            assert there == written.removeprefix("parquet:")
        assert spark.read.parquet(there).count() == (1 if "day=1" in place else 2)


@pytest.mark.parametrize(
    ("place", "said"),
    [
        ("DAYS/day=3", "DAYS/day=3: nothing is there"),
        ("parquet:DAYS/month=*", "DAYS/month=*: nothing is there"),
        ("file://DAYS/day=3", "file://DAYS/day=3: nothing is there"),
        ("DAYS/log.csv", "DAYS/log.csv: is no Parquet"),
        ("DAYS/empty", "DAYS/empty: is no Parquet"),
        ("parquet:", "parquet:: names nothing"),
        ("nosuch://bucket/log", "nosuch://bucket/log: cannot be looked up"),
        ("DAYS/[", "DAYS/[: cannot be looked up"),
    ],
)
def test_what_is_not_there_is_said(spark: SparkSession, days: Path, place: str, said: str) -> None:
    (days / "log.csv").write_text("time,signal,value\n")
    (days / "empty").touch()
    with pytest.raises(InputError) as refused:
        parquet_path(spark, place.replace("DAYS", str(days)))
    sentence = str(refused.value)
    assert sentence.startswith(said.replace("DAYS", str(days)))
    assert "expected a file or directory of Parquet" in sentence
    assert "\n" not in sentence


def test_a_stream_of_a_directory_that_is_not_there(spark: SparkSession, tmp_path: Path) -> None:
    from runglight.scale.spark.places import stream_of  # noqa: PLC0415

    with pytest.raises(InputError, match="nothing is there"):
        stream_of(spark, f"{tmp_path}/nope", "json", "earliest", 1, plant_by_key=False)


def test_the_command_says_it_without_java(spark: SparkSession, tmp_path: Path) -> None:
    assert spark is not None  # Its fixture skips where there is none.
    ended = subprocess.run(
        [sys.executable, "-m", "runglight", "spark", "learn", "/nope", "-o", "model"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )
    assert ended.returncode == 2
    *_, sentence = ended.stderr.splitlines()
    assert sentence.startswith("runglight: /nope: nothing is there; expected")
    assert "runglight export" in sentence
    assert "Exception" not in ended.stderr
    assert "\tat " not in ended.stderr
    assert not (tmp_path / "model").exists()
