"""`python -m benches.next_activity [DATA]`: how often the next activity is foretold rightly.

The counting tank of Theis 2019 (scenario 2: 22 runs, 17 to learn from, 5 to foretell), ten seeds;
and with DATA three real logs in five folds, beside the commonest activity and Markov chains.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from msgspec import structs

import runglight as rl
from benches.mined_recordings import filling, komax, signal
from benches.plants import log_of
from runglight.plants.tank import simulate_tank
from runglight.process.next_activity import Accuracy, TrainingSettings, folds, markov, train_next

SEEDS = range(10)
LEARNED = 17
TRAININGS = {
    "5 epochs of batches of 64": TrainingSettings(epochs=5, batch=64, patience=None),
    "5 epochs of batches of 8": TrainingSettings(epochs=5, batch=8, patience=None),
    "5 epochs of batches of 1": TrainingSettings(epochs=5, batch=1, patience=None),
    "100 epochs of batches of 64": TrainingSettings(epochs=100, batch=64, patience=None),
    "until it gets no better": TrainingSettings(),
}
FOLDS = 5
LARGEST = 200
"""Transitions of a net. The whole filling line has fewer, and takes two and a half minutes."""


def tank() -> None:
    """Accuracy on the runs held out, by how the network was trained."""
    run = simulate_tank(scenario="2", seed=1, lasting_s=880.0)
    log = rl.event_log(log_of(run), reset="%IX0.1=0")
    net = rl.mine(log).net
    train, test = range(LEARNED), range(LEARNED, log.traces)
    print(f"tank, scenario 2: {log.traces} runs, {len(train)} learned, {len(test)} foretold")
    for name, settings in TRAININGS.items():
        scores = []
        for seed in SEEDS:
            settled = structs.replace(settings, seed=seed)
            trained = train_next(log, net, settled, traces=train)
            scores.append(100 * trained.accuracy(log, test).share)
        print(f"{name} | " + " ".join(f"{score:.1f}" for score in scores), flush=True)
    for order in (0, 1, 2):
        print(f"Markov, order {order} | {100 * markov(log, train, test, order).share:.1f}")


def recordings(data: Path) -> None:
    """Five contiguous folds of three real logs."""
    print("log | runs | network | commonest | after the last | after the last two")
    for source in (filling, komax, signal):
        for name, log in source(data):
            net = rl.mine(log).net
            if len(net.transitions) > LARGEST:
                print(f"{name} | {log.traces} | left out: {len(net.transitions)} transitions")
                continue
            network = Accuracy(0, 0)
            baselines = [Accuracy(0, 0)] * 3
            for train, test in folds(log.traces, FOLDS):
                settings = TrainingSettings()
                network += train_next(log, net, settings, traces=train).accuracy(log, test)
                baselines = [
                    before + markov(log, train, test, order)
                    for order, before in enumerate(baselines)
                ]
            shares = " | ".join(f"{100 * each.share:.1f} %" for each in (network, *baselines))
            print(f"{name} | {log.traces} | {shares}", flush=True)


def main() -> None:
    """Prints both tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("data", type=Path, nargs="?")
    parser.add_argument("--only", choices=("tank", "recordings"))
    chosen = parser.parse_args()
    if chosen.only != "recordings":
        tank()
    if chosen.data is not None and chosen.only != "tank":
        recordings(chosen.data)


if __name__ == "__main__":
    main()
