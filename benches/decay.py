"""Decay samples per second, and training steps, beside what the machine does at best.

    python -m benches.decay

A sample costs a step of the token game and three numbers per place; the floor of any sampler is
writing those numbers down, which numpy does beside it.
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

import numpy as np

import runglight as rl
from runglight.process.next_activity import decay_samples
from tests.process.counting_tank import RESET, changes, log_of, write_net

RUNS = 20_000
AT_LEAST_PER_S = 2_000_000


def main() -> None:
    """Prints the table."""
    log = rl.event_log(log_of(changes(RUNS)), reset=RESET)
    with tempfile.TemporaryDirectory() as place:
        net = rl.read_net(write_net(Path(place) / "tank.pnml"))
    best, features = np.inf, np.empty((0, 0), dtype=np.float32)
    for _ in range(5):
        started = time.process_time()
        features, _came = decay_samples(log, net)
        best = min(best, time.process_time() - started)
    floor = np.inf
    for _ in range(5):
        started = time.process_time()
        np.empty_like(features).fill(1.0)
        floor = min(floor, time.process_time() - started)
    rate = len(features) / best
    print(f"decay samples: {len(features):,} of {features.shape[1]} features, {rate / 1e6:.1f} M/s")
    print(f"writing them down: {len(features) / floor / 1e6:.1f} M/s; ratio {best / floor:.1f}")

    tiny = log.select(range(2_000))
    started = time.process_time()
    rl.train_next(tiny, net, rl.TrainingSettings(epochs=1, patience=None))
    seconds = time.process_time() - started
    step_ms = seconds / (len(tiny) / 64) * 1e3
    print(f"training: {len(tiny) / seconds:,.0f} samples/s, {step_ms:.2f} ms a step of 64")
    if rate < AT_LEAST_PER_S:
        raise SystemExit(f"fewer than {AT_LEAST_PER_S:,} decay samples a second")


if __name__ == "__main__":
    main()
