"""The page of the Spark figures, written from what was measured."""

from __future__ import annotations

import math
from typing import Any

A_DAY = 10_000_000_000
SECONDS = 86_400
EVERY_S = 10.0
"""The micro-batch that the projection assumes."""


def page(result: dict[str, Any]) -> str:
    """docs/reference/spark.md."""
    machine = result["machine"]
    measured = result["measured"]
    single_us = result["one_process_us"]
    lines = [
        "# Figures: watching on Spark",
        "",
        "Written by `python -m benches.spark_figures --publish`; kills by "
        "`python -m benches.spark_kills`. How to: [the guide](../guides/spark.md).",
        "",
        f"{machine['cores']} cores ({machine['processor']}), {machine['memory_gb']} GB, Python "
        f"{machine['python']}, PySpark 4.0.0, Java 17; load when it ended: "
        f"{', '.join(f'{each:.1f}' for each in machine['load'])}. Driver, executors and (for "
        "topics) the broker share these cores, so two workers are not twice one.",
        "",
        f"Body shop `{result['plant']}`, {result['events']:,} events of which one in 500 is "
        f"missing, "
        f"{result['findings']:,} findings, {result['parts']} parts. Rates are of the "
        "micro-batches after the first, from Spark's own progress: reading, judging, state "
        "and checkpoint. "
        "Processor time is that of the driver, the executors and their Python workers together.",
        "",
        "| stream | workers | events in a micro-batch | events/s | processor us per event "
        "| findings equal to one machine's |",
        "|---|---|---|---|---|---|",
        f"| one process, no Spark (judging alone) | | {result['events']:,} | "
        f"{1e6 / single_us:,.0f} | {single_us:.2f} | |",
    ]
    lines += [
        f"| {each['stream']} | {each['workers']} | {each['events_in_a_batch']:,} | "
        f"{each['events'] / each['seconds']:,.0f} | "
        f"{each['processor_s'] / each['events'] * 1e6:.2f} | "
        f"{'yes, all' if each['equal'] else 'no'} {each['findings']:,} |"
        for each in measured
    ]
    lines += ["", "## What an event costs", "", *_cost(measured, single_us), ""]
    return "\n".join(lines)


def _cost(measured: list[dict[str, Any]], single_us: float) -> list[str]:
    narrow, wide = _of(measured, "Parquet files"), _of(measured, "Parquet files, large batches")
    # Two sizes of micro-batch tell what each costs by itself, and what each event costs on top.
    batches = [each["events"] / each["events_in_a_batch"] for each in (narrow, wide)]
    spent = [each["processor_s"] / of for each, of in zip((narrow, wide), batches, strict=True)]
    rows = [each["events_in_a_batch"] for each in (narrow, wide)]
    event_us = max((spent[1] - spent[0]) / (rows[1] - rows[0]) * 1e6, single_us)
    batch_s = max(spent[0] - event_us * rows[0] / 1e6, 0.0)
    rate = A_DAY / SECONDS
    cores = rate * event_us / 1e6 + batch_s / EVERY_S
    times = event_us / single_us
    lines = [
        f"By the two sizes of micro-batch (one worker, Parquet): **{batch_s:.2f} s of processor "
        f"for a micro-batch, however small, and {event_us:.2f} us for an event**, {times:.0f} "
        f"times the "
        f"{single_us:.2f} us that judging it costs. The rest is Spark's: reading, handing rows to "
        "Python and back, the shuffle. A micro-batch without events took "
        f"{narrow['empty_batch_s']:.1f} s.",
        "",
        "## 10 billion events a day",
        "",
        f"{rate:,.0f} events a second, on average. With a micro-batch every {EVERY_S:.0f} s: "
        f"{rate:,.0f} x {event_us:.2f} us + {batch_s:.2f} s / {EVERY_S:.0f} s = {cores:.1f} cores "
        f"busy; with half of them idle for peaks, **{math.ceil(2 * cores)} cores** from Parquet. "
        + " ".join(_topic(measured, name, batch_s, rate) for name in ("binary", "JSON")),
        "",
        f"One process without Spark needs {rate * single_us / 1e6:.2f} cores to judge the same. "
        "This is a projection from one machine, not a run of a cluster: the cost of an event is "
        "taken to stay what it is here, the cost of a micro-batch grows with the number of "
        "partitions, and "
        "the network between computers is not in it.",
    ]
    return lines


def _topic(measured: list[dict[str, Any]], format: str, batch_s: float, rate: float) -> str:
    each = _of(measured, f"Kafka, {format}")
    batches = each["events"] / each["events_in_a_batch"]
    event_us = (each["processor_s"] - batches * batch_s) / each["events"] * 1e6
    cores = rate * event_us / 1e6 + batch_s / EVERY_S
    return (
        f"From a topic of {format} messages an event costs {event_us:.2f} us, and it takes "
        f"**{math.ceil(2 * cores)} cores**."
    )


def _of(measured: list[dict[str, Any]], stream: str) -> dict[str, Any]:
    return next(each for each in measured if each["stream"] == stream and each["workers"] == 1)
