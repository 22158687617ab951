"""Spark sessions on this machine, with everything they write in one directory."""

from __future__ import annotations

import gc
import os
import subprocess
import sys
import warnings
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pyspark.sql import SparkSession

CLUSTER = "local-cluster[2,1,1024]"


def new_session(
    master: str,
    directory: Path,
    jars: Iterable[Path] = (),
    partitions: int = 2,
    settings: dict[str, str] | None = None,
) -> SparkSession:
    """A session on loopback alone; `directory` takes its files, even those of a killed one."""
    import pyspark  # noqa: PLC0415
    from pyspark.sql import SparkSession  # noqa: PLC0415

    scratch = directory / "scratch"
    scratch.mkdir(parents=True, exist_ok=True)
    root = Path(__file__).parents[2]
    os.environ.update(
        SPARK_HOME=str(_home(Path(pyspark.__file__).parent, directory)),
        SPARK_LOCAL_IP="127.0.0.1",
        SPARK_LOCAL_HOSTNAME="127.0.0.1",
        PYSPARK_PYTHON=sys.executable,
        PYSPARK_DRIVER_PYTHON=sys.executable,
        PYTHONPATH=os.pathsep.join([str(root / "python"), str(root)]),
    )
    # RocksDB leaves its library in the temporary folder when it is killed.
    java = f"-XX:+UseSerialGC -Djava.io.tmpdir={scratch} -Dlog4j2.level=ERROR"
    builder = SparkSession.builder.master(master).appName("runglight")
    for key, value in {
        "spark.driver.host": "127.0.0.1",
        "spark.driver.bindAddress": "127.0.0.1",
        "spark.driver.memory": "1g",
        "spark.ui.enabled": "false",
        "spark.ui.showConsoleProgress": "false",
        "spark.driver.extraJavaOptions": java,
        "spark.executor.extraJavaOptions": java,
        "spark.executor.cores": "1",
        "spark.local.dir": str(scratch),
        "spark.sql.warehouse.dir": str(scratch / "warehouse"),
        "spark.sql.session.timeZone": "UTC",
        "spark.sql.shuffle.partitions": str(partitions),
        "spark.jars": ",".join(map(str, jars)),
        **(settings or {}),
    }.items():
        builder = builder.config(key, value)
    session = builder.getOrCreate()
    session.sparkContext.setLogLevel("ERROR")
    return session


def end(session: SparkSession) -> None:
    """Ends a session and its Java machine, so that nothing of it is left to later tests."""
    from pyspark import SparkContext  # noqa: PLC0415

    gateway = session.sparkContext._gateway
    session.stop()
    gateway.shutdown()
    # Java ends when its standard input does.
    gateway.proc.stdin.close()
    try:
        gateway.proc.wait(30)
    except subprocess.TimeoutExpired:
        gateway.proc.kill()
        gateway.proc.wait()
    SparkContext._gateway = SparkContext._jvm = None
    # py4j leaves the sockets of its threads to the collector, which warns of each.
    del gateway
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResourceWarning)
        gc.collect()


def _home(installed: Path, directory: Path) -> Path:
    # Workers of a local cluster write beside Spark itself; here that is a directory of links.
    home = directory / "home"
    home.mkdir(exist_ok=True)
    for entry in installed.iterdir():
        link = home / entry.name
        if entry.name != "work" and not link.exists():
            link.symlink_to(entry)
    return home
