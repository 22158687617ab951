"""Watching on Spark beside one process: equal findings, events per second, the cost of an event.

    python -m benches.spark_figures [--events 1000000] [--publish]

Body shop `a` with one change in 500 missing, as Parquet files and as a Kafka topic. Rates are those
of the micro-batches after the first, by Spark's own progress; processor seconds are those of all
processes of the cluster in that time. `--publish` writes docs/reference/spark.md.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from benches.machine import machine
from runglight.log.changelog import Log
from runglight.model import NominalModel
from runglight.scale.spark import KafkaChanges, ParquetSink, from_kafka, watch
from runglight.scale.wire import encode_binary
from tests.scale import feeding, killing, needed
from tests.scale.broker import Broker, running
from tests.scale.feeding import SECOND
from tests.scale.sessions import end, new_session

PAGE = Path(__file__).parents[1] / "docs" / "reference" / "spark.md"
FILES = 11
DELAY_S = 10
A_DAY = 10_000_000_000


@dataclass(frozen=True)
class Measured:
    """One stream, watched to its end."""

    stream: str
    workers: int
    events: int
    events_in_a_batch: int
    seconds: float
    processor_s: float
    empty_batch_s: float
    equal: bool
    late: int
    findings: int

    @property
    def rate(self) -> float:
        """Events per second."""
        return self.events / self.seconds

    @property
    def per_event_us(self) -> float:
        """Processor microseconds of one event."""
        return self.processor_s / self.events * 1e6


def alone(model: NominalModel, log: Log, until_ns: int) -> tuple[list[str], float]:
    """What one process finds, and the processor seconds it takes."""
    monitor = model.monitor()
    began = time.process_time()
    lines = monitor.observe(log).json_lines() + monitor.advance(until_ns).json_lines()
    return sorted(lines), time.process_time() - began


def processor_s(process: int) -> float:
    """Processor seconds of a process and all it started, ended ones too."""
    try:
        status = Path(f"/proc/{process}/stat").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return 0.0
    fields = status.rpartition(")")[2].split()
    own = sum(map(int, fields[11:15])) / os.sysconf("SC_CLK_TCK")
    return own + sum(map(processor_s, killing.children(process)))


def measure(
    session: Any,
    name: str,
    workers: int,
    *,
    stream: Any,
    model: NominalModel,
    directory: Path,
    expected: list[str],
) -> Measured:
    """Watches a stream to its end."""
    shutil.rmtree(directory, ignore_errors=True)
    java = session.sparkContext._gateway.proc.pid
    watching = watch(
        stream,
        model,
        ParquetSink(str(directory / "out")),
        checkpoint=str(directory / "checkpoint"),
        delay_s=DELAY_S,
        ahead_s=None,
        until_here=True,
    )
    # The first micro-batch starts Python, loads the model and compiles the plan.
    killing.wait_until(
        lambda: killing.committed(directory / "checkpoint") >= 1 or not watching.query.isActive,
        "the first micro-batch",
    )
    began = processor_s(java)
    watching.wait()
    spent = processor_s(java) - began
    progress = [each for each in watching.query.recentProgress if each.batchId > 0]
    full = [each for each in progress if each.numInputRows > 1]
    empty = [each.durationMs["triggerExecution"] / 1000 for each in progress if each not in full]
    seconds = [each.durationMs["triggerExecution"] / 1000 for each in full]
    found = feeding.found(session, directory / "out")
    late = [json.loads(line)["message"] for line in found if "too late" in line]
    measured = Measured(
        name,
        workers,
        sum(each.numInputRows for each in full),
        max(each.numInputRows for each in full),
        sum(seconds),
        spent,
        min(empty, default=0.0),
        found == expected,
        len(late),
        len(found),
    )
    print(
        f"{name}, {workers} workers: {measured.rate:,.0f} events/s, "
        f"{measured.per_event_us:.2f} us of processor per event, "
        f"{'equal' if measured.equal else 'NOT EQUAL'} ({len(found)} of {len(expected)})",
        flush=True,
    )
    return measured


def fill(broker: Broker, log: Log, end_ns: int) -> None:
    """The log as two topics."""
    time_ns, index, value = log.columns()
    names = np.array(log.signals, object)[index]
    rows = list(zip(time_ns.tolist(), names.tolist(), value.tolist(), strict=True))
    broker.create("binary")
    messages = [(None, encode_binary(*row)) for row in rows]
    broker.send("binary", [*messages, (None, encode_binary(end_ns, "", 0))])
    broker.create("json")
    texts = [
        (None, b'{"time":%d,"signal":"%s","value":%d}' % (at, name.encode(), set_to))
        for at, name, set_to in rows
    ]
    broker.send("json", [*texts, (None, b'{"time":%d}' % end_ns)])


def kafka(session: Any, broker: Broker, format: Any, events: int) -> KafkaChanges:
    """A topic, in as many micro-batches as there are files."""
    return from_kafka(
        session, broker.servers, format, format, rows_at_once=events // (FILES - 1) + 1
    )


def main() -> int:
    """Measures, prints, and writes the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--events", type=int, default=1_000_000)
    parser.add_argument("--size", default="a")
    parser.add_argument("--learn-events", type=int, default=2_700_000)
    parser.add_argument("--publish", action="store_true")
    options = parser.parse_args()
    model, log = feeding.body_shop(options.size, options.learn_events, options.events)
    end_ns = feeding.last_ns(log) + 400 * SECOND
    expected, one_process_s = alone(model, log, end_ns - DELAY_S * SECOND - 1)
    print(f"one process: {len(log) / one_process_s:,.0f} events/s, {len(expected)} findings")
    print(f"load {os.getloadavg()}", flush=True)
    measured: list[Measured] = []
    with tempfile.TemporaryDirectory(prefix="runglight-figures-") as scratch:
        root = Path(scratch)
        pieces = feeding.cut(feeding.rows_of(log), FILES)
        feeding.write(root / "in", [*pieces, feeding.heartbeat(end_ns)])
        with running(needed.jars("broker"), root / "kafka") as broker:
            fill(broker, log, end_ns)
            for workers in (1, 2):
                session = new_session(
                    f"local-cluster[{workers},1,2048]",
                    root / f"session-{workers}",
                    needed.jars("connector"),
                )
                streams = {
                    "Parquet files": partial(feeding.stream, session, root / "in"),
                    "Kafka, binary": partial(kafka, session, broker, "binary", len(log)),
                    "Kafka, JSON": partial(kafka, session, broker, "json", len(log)),
                }
                try:
                    for name, stream in streams.items():
                        measured.append(
                            measure(
                                session,
                                name,
                                workers,
                                stream=stream(),
                                model=model,
                                directory=root / "run",
                                expected=expected,
                            )
                        )
                    if workers == 1:
                        # All but the first file at once: what a batch costs, and what an event.
                        wide = feeding.stream(session, root / "in", FILES // 2)
                        measured.append(
                            measure(
                                session,
                                "Parquet files, large batches",
                                workers,
                                stream=wide,
                                model=model,
                                directory=root / "run",
                                expected=expected,
                            )
                        )
                finally:
                    end(session)
    result = {
        "machine": {**machine(), "pyspark": version("pyspark")},
        "plant": options.size,
        "events": len(log),
        "parts": len(model.parts()),
        "findings": len(expected),
        "one_process_us": one_process_s / len(log) * 1e6,
        "measured": [asdict(each) for each in measured],
    }
    print(json.dumps(result, indent=1))
    if options.publish:
        from benches.spark_text import page  # noqa: PLC0415

        PAGE.write_text(page(result), encoding="utf-8")
    return 0 if all(each.equal for each in measured) else 1


if __name__ == "__main__":
    sys.exit(main())
