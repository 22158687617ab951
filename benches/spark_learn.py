"""Learning on Spark beside one machine: the same log, the same model, and what each takes.

    python benches/spark_learn.py [--size a] [--learn-events N] [--master local[2]]

Needs `pip install "runglight[spark]"` and Java 17. The log is written as eight Parquet files in no
order; both learn from it, and the rules are compared byte for byte.
"""

from __future__ import annotations

import argparse
import json
import os
import tempfile
from pathlib import Path
from time import perf_counter

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from runglight.log.changelog import Log
from runglight.model import learn
from runglight.plants.bodyshop import simulate_bodyshop

FILES = 8


def written(size: str, events: int | None, directory: Path) -> pa.Table:
    """The rows of the learning part, also written to files in disorder."""
    run = simulate_bodyshop(size, learn_events=events, watch_events=10_000).learn
    names = pa.array(np.array(run.signals, object)[run.signal_index])
    rows = pa.table(
        {"time": run.time_ns, "signal": names, "value": run.value, "row": range(len(run.value))}
    )
    order = np.random.default_rng(1).permutation(len(rows))
    for number in range(FILES):
        pq.write_table(rows.take(order[number::FILES]), directory / f"{number}.parquet")
    return rows


def main() -> None:
    """Prints one JSON object a line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--size", default="a")
    parser.add_argument("--learn-events", type=int)
    parser.add_argument("--master", default="local[2]")
    given = parser.parse_args()
    from pyspark.sql import SparkSession  # noqa: PLC0415

    from runglight.scale.spark import learn as learn_there  # noqa: PLC0415

    with tempfile.TemporaryDirectory() as temporary:
        directory = Path(temporary)
        (directory / "log").mkdir()
        rows = written(given.size, given.learn_events, directory / "log")
        print(json.dumps({"events": len(rows), "load": os.getloadavg()[0]}), flush=True)
        start = perf_counter()
        time = rows["time"].cast(pa.timestamp("ns", "UTC"))
        log = Log.from_arrow(rows.drop_columns("row").set_column(0, "time", time))
        read_s = perf_counter() - start
        start = perf_counter()
        learn(log).save(directory / "here")
        told = {"read_s": read_s, "learn_s": perf_counter() - start}
        print(json.dumps({"one_machine": told, "load": os.getloadavg()[0]}), flush=True)
        del log, rows
        builder = SparkSession.builder.master(given.master).config("spark.ui.enabled", "false")
        settings = {
            "spark.driver.host": "127.0.0.1",
            "spark.driver.bindAddress": "127.0.0.1",
            "spark.driver.memory": "2g",
            "spark.driver.extraJavaOptions": "-XX:+UseSerialGC",
            "spark.sql.session.timeZone": "UTC",
            "spark.local.dir": temporary,
        }
        for key, value in settings.items():
            builder = builder.config(key, value)
        session = builder.getOrCreate()
        session.sparkContext.setLogLevel("ERROR")
        frame = session.read.parquet(str(directory / "log"))
        for attempt in ("cold", "warm"):
            start = perf_counter()
            model = learn_there(frame, order="row")
            taken_s = perf_counter() - start
            load = os.getloadavg()[0]
            print(json.dumps({"spark": attempt, "learn_s": taken_s, "load": load}), flush=True)
        model.save(directory / "there")
        session.stop()
        rules = [(directory / name / "rules.parquet").read_bytes() for name in ("here", "there")]
        print(json.dumps({"rules_bytes": len(rules[0]), "equal": rules[0] == rules[1]}), flush=True)


if __name__ == "__main__":
    main()
