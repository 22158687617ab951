"""Split Miner beside an independent implementation whose results are recorded."""

import json

from benches.split_miner_oracle import RECORD, SEEDS, ours, score, worse


def test_models_are_as_good_as_the_oracles() -> None:
    record = json.loads(RECORD.read_text(encoding="utf-8"))
    assert len(record) == len(SEEDS)
    found = {seed: ours(int(seed)) for seed in record}
    bad = [seed for seed in record if worse(found[seed], record[seed])]
    assert len(bad) <= 0.05 * len(record), bad
    assert sum(map(score, found.values())) >= sum(map(score, record.values()))


def test_a_worse_model_is_seen() -> None:
    good = {"sound": True, "fitting": 1.0, "fitness": 1.0, "precision": 0.8}
    assert worse(good | {"sound": False}, good)
    assert worse(good | {"fitting": 0.9}, good)
    assert worse(good | {"precision": 0.7}, good)
    assert not worse(good | {"precision": 0.9}, good)
    assert not worse(good, good | {"sound": False, "precision": 1.0})
