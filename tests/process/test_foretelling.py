"""What may come next, held against what the network says of what came."""

import pytest

import runglight as rl
from runglight.process.foretelling import chances
from tests.process.counting_tank import RESET, changes, log_of


def test_every_activity_has_its_probability() -> None:
    log = rl.event_log(log_of(changes(8)), reset=RESET)
    net = rl.mine(log).net
    network = rl.train_next(log, net)
    activity, time_ns, bounds = log.columns()
    names = [name for name, _ in log.activities]
    first, end = int(bounds[2]), int(bounds[3])
    run = [(int(time_ns[n]), names[activity[n]]) for n in range(first, end)]
    told = network.foretell(log, [2])
    looked = 0
    for event, came, probability in zip(
        told["event"], told["came"], told["probability"], strict=True
    ):
        if event == 0:
            continue
        found = chances(network, run[: int(event)])
        assert sum(share for _, share in found) == pytest.approx(1, abs=1e-4)
        assert dict(found)[names[came]] == pytest.approx(float(probability), abs=2e-2)
        looked += 1
    assert looked > 10


def test_nothing_is_said_before_a_run_opens() -> None:
    log = rl.event_log(log_of(changes(4)), reset=RESET)
    settings = rl.TrainingSettings(epochs=1, patience=None)
    assert chances(rl.train_next(log, rl.mine(log).net, settings), []) == []
