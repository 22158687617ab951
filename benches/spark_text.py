"""The page of the Spark figures, written from what was measured."""

from __future__ import annotations

import math
from typing import Any

A_DAY = 10_000_000_000
SECONDS = 86_400


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
        f"{machine['python']}, PySpark {machine['pyspark']}, Java 17; load when it ended: "
        f"{', '.join(f'{each:.1f}' for each in machine['load'])}. Driver, executors and (for "
        "topics) the broker share these cores, so two workers are not twice one; where the load is "
        "above the number of cores, other work had part of them, and a free machine is faster.",
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
    rate = A_DAY / SECONDS
    ones = [each for each in measured if each["workers"] == 1]
    costs = {each["stream"]: each["processor_s"] / each["events"] * 1e6 for each in ones}
    dearest, cheapest = max(costs.values()), min(costs.values())
    empty_s = min(each["empty_batch_s"] for each in measured)
    return [
        f"Judging an event costs {single_us:.2f} us in one process, and on Spark, with all that "
        f"belongs to it, {cheapest:.1f} to {dearest:.1f} us of processor: "
        f"{cheapest / single_us:.0f} "
        f"to {dearest / single_us:.0f} times as much. The rows stand in the order in which "
        f"they were "
        "measured, in one session for each number of workers: Java compiles what it runs while it "
        "runs, so the first stream of a session pays for the ones after it, and the differences "
        "between the streams are mostly that. Reading and packing cost 0.4 us of it and a part's "
        "judging with its state 0.8 us (profiled without Spark, 8 micro-batches of 50,000 events); "
        "the rest is Spark's: planning, Java, the "
        "shuffle, state, checkpoint, findings. "
        f"A micro-batch without events took {empty_s:.1f} s at the load named above.",
        "",
        "## 10 billion events a day",
        "",
        f"{rate:,.0f} events a second on average. At the measured cost of an event with one "
        f"worker, "
        f"{cheapest:.1f} to {dearest:.1f} us, that keeps {rate * cheapest / 1e6:.1f} to "
        f"{rate * dearest / 1e6:.1f} cores busy; with half of them idle for peaks, "
        f"**{math.ceil(2 * rate * cheapest / 1e6)} to {math.ceil(2 * rate * dearest / 1e6)} "
        f"cores**. "
        f"One process without Spark needs {rate * single_us / 1e6:.2f} cores to judge the same. "
        "This is a projection from one machine, not a run of a cluster: the cost of an event is "
        "taken to stay what it is here (micro-batches of about 90,000 events), and the network "
        "between computers is not in it.",
    ]
