"""As a site runs it: a machine feeds a topic, `spark-submit` watches it."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pyarrow.parquet as pq

from runglight import _engine
from runglight.cli import main
from runglight.model import NominalModel, learn, load_model
from tests.conftest import simulated
from tests.scale import feeding, needed
from tests.scale.broker import Broker
from tests.scale.killing import PATIENCE_S, ROOT

if TYPE_CHECKING:
    from pyspark.sql import SparkSession


def test_a_topic_is_fed_and_watched(
    spark: SparkSession,
    broker: Broker,
    nominal_model: NominalModel,
    tmp_path: Path,
) -> None:
    log = simulated(seed=2, fault=2)
    _engine.write_log(log.engine, str(tmp_path / "log.parquet"))
    nominal_model.save(tmp_path / "model")
    broker.create("fed")
    topic = f"kafka://{broker.servers}/fed"
    assert main(["spark", "feed", f"replay:{tmp_path}/log.parquet?speed=max", topic]) == 0

    told = submitted(
        tmp_path,
        *("watch", str(tmp_path / "model"), topic),
        *("--to", str(tmp_path / "out"), "--checkpoint", str(tmp_path / "checkpoint")),
        *("--delay", "1s", "--ahead", "never", "--until-here"),
    )
    assert "watched to its end" in told
    # Nothing comes after the log: its last second waits.
    last_ns = feeding.last_ns(log) // 10**6 * 10**6 - feeding.SECOND
    before = int((log.columns()[0] < last_ns).sum())
    alone = sorted(nominal_model.monitor().observe(log.slice(0, before)).json_lines())
    assert len(alone) > 10
    assert feeding.found(spark, tmp_path / "out") == alone


def test_a_log_is_learned(spark: SparkSession, tmp_path: Path) -> None:
    log = simulated()
    rows = feeding.rows_of(log)
    pq.write_table(rows, tmp_path / "log.parquet")
    told = submitted(
        tmp_path,
        *("learn", str(tmp_path / "log.parquet"), "--output", str(tmp_path / "model")),
        *("--order-column", "offset", "--timing", "plat"),
    )
    assert "model" in told
    learned = load_model(tmp_path / "model")
    assert learned.rules_json() == learn(log, timing="plat").rules_json()


def submitted(directory: Path, *arguments: str) -> str:
    """What `spark-submit` prints, of both streams, when it has run a command."""
    home = Path(os.environ["SPARK_HOME"])
    main_file = subprocess.run(
        [sys.executable, "-m", "runglight.scale.submit"], capture_output=True, text=True, check=True
    )
    jars = ",".join(map(str, needed.jars("connector")))
    ended = subprocess.run(
        [
            *(str(home / "bin" / "spark-submit"), "--master", "local[2]", "--jars", jars),
            *("--conf", "spark.ui.enabled=false", "--conf", "spark.sql.shuffle.partitions=2"),
            *("--conf", f"spark.local.dir={directory}", "--conf", "spark.driver.host=127.0.0.1"),
            *("--driver-java-options", f"-Djava.io.tmpdir={directory}"),
            *(main_file.stdout.strip(), *arguments),
        ],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )
    assert ended.returncode == 0, ended.stderr[-2000:]
    return ended.stdout + ended.stderr
