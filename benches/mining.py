"""`python -m benches.mining`: how fast an I/O log becomes a net.

A tank-like machine whose runs differ (choices, loops and outputs that swap), 440,000 events. Timed
are both steps: cutting the log into runs, and mining them; each is the best of five.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from itertools import count
from typing import TypeVar

import numpy as np

import runglight as rl

Result = TypeVar("Result")

EVENTS = 440_000
SIGNALS = [f"%IX0.{bit}" for bit in range(8)] + [f"%QX0.{bit}" for bit in range(8)]


def machine(events: int, seed: int = 1) -> rl.Log:
    """Runs of some 22 changes; the reset is `%IX0.0=1`."""
    chance = np.random.default_rng(seed)
    state = [0] * len(SIGNALS)
    times: list[int] = []
    signals: list[int] = []
    clock = count()

    def change(signal: int) -> None:
        state[signal] ^= 1
        times.append(next(clock) * 10_000_000)
        signals.append(signal)

    values: list[int] = []
    while len(times) < events:
        first = len(times)
        change(0)
        loops = int(chance.integers(1, 4))
        for _ in range(loops):
            change(8)
            change(1)
            change(8)
            change(1)
        outputs = [9, 10, 11]
        chance.shuffle(outputs)
        for output in outputs:
            change(output)
        branch = 2 if chance.random() < 0.5 else 3
        change(branch)
        change(12)
        change(branch)
        change(12)
        for output in (9, 10, 11):
            change(output)
        change(0)
        values.extend([0] * (len(times) - first))
    replayed = [0] * len(SIGNALS)
    for row, signal in enumerate(signals):
        replayed[signal] ^= 1
        values[row] = replayed[signal]
    return rl.Log.from_columns(
        np.array(times[:events], np.int64),
        np.array(signals[:events], np.uint32),
        np.array(values[:events], np.int64),
        SIGNALS,
    )


def best_of(times: int, work: Callable[[], Result]) -> tuple[float, Result]:
    """Seconds of the fastest run, and what the last one gave."""
    seconds = []
    for _ in range(times):
        start = time.perf_counter()
        result = work()
        seconds.append(time.perf_counter() - start)
    return min(seconds), result


def main() -> None:
    """Prints one line per step."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--events", type=int, default=EVENTS)
    chosen = parser.parse_args()
    log = machine(chosen.events)
    cutting_s, events = best_of(5, lambda: rl.event_log(log, reset="%IX0.0=1"))
    mining_s, mined = best_of(5, lambda: rl.mine(events))
    judging_s, quality = best_of(1, lambda: mined.net.quality(events))
    print(f"{len(log):,} changes, {events.traces:,} runs, {len(events):,} events")
    print(f"cut into runs   {cutting_s:.3f} s")
    print(f"mined           {mining_s:.3f} s")
    print(f"together        {cutting_s + mining_s:.3f} s")
    print(f"quality         {judging_s:.3f} s")
    print(
        f"sound {quality.soundness.sound}, fitness {quality.fitness.fitness:.4f}, "
        f"precision {quality.precision:.4f}"
    )


if __name__ == "__main__":
    main()
