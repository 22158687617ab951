"""Identification at the size of a plant: `python -m benches.identify [--signals N] [--hours H]`.

How often real signals change: 108 times an hour in the filling station (2,196 edges of 69 binary
signals in 17.6 min), 186 at the crossing. Here 30 % never change, 35 % a few times a shift, 30 %
at most with each of 400 parts an hour, 5 % at most every two seconds: 114 an hour on average. A
quarter are words: counters, packed bits, measurements. Processor time, which other work disturbs
least.
"""

import argparse
import json
from functools import partial

import numpy as np

import runglight as rl
from benches.machine import machine
from benches.stopwatch import Stopwatch
from runglight.log.changelog import Log

HOUR_NS = 3_600_000_000_000
PARTS = 400
START_NS = 1_704_153_600_000_000_000
REPETITIONS = 5
WORD_EVERY = 4


def plant(signals: int, hours: float, seed: int = 1) -> tuple[Log, list[int], str]:
    """A log, events, and the address they belong to."""
    random = np.random.default_rng(seed)
    kind = random.choice(4, signals, p=[0.30, 0.35, 0.30, 0.05])
    hourly = np.select(
        [kind == 1, kind == 2, kind == 3],
        [random.integers(0, 4, signals), random.integers(20, PARTS, signals),
         random.integers(200, 1800, signals)],
        default=0,
    )  # fmt: skip
    changes = (hourly * hours).astype(np.int64)
    words = np.arange(signals) % WORD_EVERY == 0
    parts = START_NS + (np.arange(1, int(PARTS * hours)) * HOUR_NS // PARTS)
    counter = int(np.flatnonzero(words)[len(words) // 8])
    changes[counter] = 0
    index = np.repeat(np.arange(signals, dtype=np.uint32), changes)
    time_ns = START_NS + random.integers(1, int(HOUR_NS * hours), len(index))
    order = np.lexsort((time_ns, index))
    index, time_ns = index[order], time_ns[order]
    nth = np.arange(len(index)) - np.repeat(np.cumsum(changes) - changes, changes) + 1
    value = nth % 2
    of_word = words[index]
    style = index // WORD_EVERY % 3
    value = np.where(of_word & (style == 0), nth, value)
    value = np.where(of_word & (style == 1), 1 << (nth % 16), value)
    value = np.where(of_word & (style == 2), (nth * 977) % 4096, value)
    everything = np.arange(signals, dtype=np.uint32)
    columns = [
        np.concatenate([np.full(signals, START_NS), time_ns, parts]),
        np.concatenate([everything, index, np.full(len(parts), counter, np.uint32)]),
        np.concatenate([np.zeros(signals, np.int64), value, np.arange(1, len(parts) + 1)]),
    ]
    order = np.argsort(columns[0], kind="stable")
    names = [f"%MW{at}" if words[at] else f"%M{at}" for at in range(signals)]
    time_ns, index, value = (column[order] for column in columns)
    log = Log.from_columns(time_ns, index, value, names)
    declared = parts + random.integers(0, 1_000_000_000, len(parts))
    return log, declared[random.random(len(parts)) > 0.05].tolist(), names[counter]


def measure(signals: int, hours: float) -> dict[str, object]:
    """Seconds of processor time, least of five."""
    log, events, right = plant(signals, hours)
    watch, views = Stopwatch(), {}
    for view in ("all", "increments"):
        watch = Stopwatch()
        for _ in range(REPETITIONS):
            found = watch.time(partial(rl.identify, log, events, tau_s=2, view=view))
        assert right in {each.address for each in found.best(2)}, found[0]
        views[view] = {"seconds": round(watch.best, 3), "changing": found.changing}
    rows = len(log)
    return {
        "signals": signals,
        "hours": hours,
        "rows": rows,
        "events": len(events),
        "views": views,
        "rows_per_s": round(rows / views["all"]["seconds"]),
        "machine": machine(),
    }


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--signals", type=int, default=100_000)
    parser.add_argument("--hours", type=float, default=1.0)
    asked = parser.parse_args()
    print(json.dumps(measure(asked.signals, asked.hours), indent=1))


if __name__ == "__main__":
    main()
