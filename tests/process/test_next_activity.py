"""The network that foretells the next activity: what it learns, keeps, refuses."""

import json
from pathlib import Path

import numpy as np
import pytest

import runglight as rl
from runglight.errors import InputError, ModelError
from runglight.process.next_activity import folds, markov
from tests.process.counting_tank import RESET, changes, log_of, write_net

ENOUGH = rl.TrainingSettings(epochs=120, batch=16, seed=1, patience=None)


@pytest.fixture(scope="module")
def runs() -> rl.EventLog:
    return rl.event_log(log_of(changes(22)), reset=RESET)


@pytest.fixture(scope="module")
def net(tmp_path_factory: pytest.TempPathFactory) -> rl.PetriNet:
    return rl.read_net(write_net(tmp_path_factory.mktemp("net") / "tank.pnml"))


@pytest.fixture(scope="module")
def trained(runs: rl.EventLog, net: rl.PetriNet) -> rl.NextActivity:
    return rl.train_next(runs, net, ENOUGH, traces=range(17), events={"reset": RESET})


def test_counting_beats_what_follows_the_last_activities(
    runs: rl.EventLog, trained: rl.NextActivity
) -> None:
    test = range(17, 22)
    network = trained.accuracy(runs, test)
    assert network.share == 1.0
    for order in (0, 1, 2):
        baseline = markov(runs, range(17), test, order)
        assert baseline.events == network.events
        assert baseline.share < 0.97


def test_the_reset_that_ends_a_run_is_foretold(runs: rl.EventLog, trained: rl.NextActivity) -> None:
    told = trained.foretell(runs, range(17, 21))
    openings = told["event"] == 0
    assert openings.sum() == 4
    names = [name for name, _ in runs.activities]
    assert {names[came] for came in told["came"][openings]} == {RESET}
    assert told["right"][openings].all()


def test_a_seed_is_a_network(runs: rl.EventLog, net: rl.PetriNet) -> None:
    def probabilities(seed: int) -> np.ndarray:
        settings = rl.TrainingSettings(epochs=2, seed=seed, patience=None)
        return np.asarray(rl.train_next(runs, net, settings).foretell(runs)["probability"])

    assert (probabilities(1) == probabilities(1)).all()
    assert (probabilities(1) != probabilities(2)).any()


def test_progress_is_told_and_may_stop_everything(runs: rl.EventLog, net: rl.PetriNet) -> None:
    told: list[tuple[int, float, float | None]] = []

    def progress(epoch: int, loss: float, held_out: float | None) -> None:
        told.append((epoch, loss, held_out))
        if epoch == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        rl.train_next(runs, net, ENOUGH, progress=progress)
    assert [epoch for epoch, _, _ in told] == [1, 2, 3]
    assert told[0][1] > told[2][1]


def test_early_stopping_ends_when_nothing_gets_better(runs: rl.EventLog, net: rl.PetriNet) -> None:
    told: list[float] = []
    settings = rl.TrainingSettings(epochs=2000, batch=16, learning_rate=0.01, patience=5)

    def progress(_epoch: int, _loss: float, held_out: float | None) -> None:
        assert held_out is not None
        told.append(held_out)

    rl.train_next(runs, net, settings, progress=progress)
    assert len(told) < 2000
    assert min(told) == told[-6]


def test_what_is_saved_is_what_is_loaded(
    runs: rl.EventLog, net: rl.PetriNet, trained: rl.NextActivity, tmp_path: Path
) -> None:
    place = tmp_path / "next"
    trained.save(place)
    trained.save(place)
    assert sorted(file.name for file in place.iterdir()) == ["network.safetensors", "next.json"]
    assert [entry.name for entry in tmp_path.iterdir()] == ["next"]
    again = rl.load_next(place, net)
    assert (again.foretell(runs)["probability"] == trained.foretell(runs)["probability"]).all()
    assert again.training == trained.training
    assert again.training["settings"]["epochs"] == 120
    assert again.training["events"] == {"reset": RESET}


def test_damaged_and_foreign_networks_are_refused(
    net: rl.PetriNet, trained: rl.NextActivity, tmp_path: Path
) -> None:
    place = tmp_path / "next"
    with pytest.raises(ModelError, match="no trained network here"):
        rl.load_next(place, net)
    trained.save(place)
    other = rl.read_net(write_net(tmp_path / "other.pnml", without="%IX0.1=1"))
    with pytest.raises(ModelError, match=r"another net than other\.pnml"):
        rl.load_next(place, other, "other.pnml")

    description, weights = place / "next.json", place / "network.safetensors"
    sound = weights.read_bytes()
    for damaged in (sound[:-1], sound[:200] + bytes([sound[200] ^ 1]) + sound[201:], b""):
        weights.write_bytes(damaged)
        with pytest.raises(ModelError, match="is not the file that"):
            rl.load_next(place, net)
    weights.unlink()
    with pytest.raises(ModelError, match=r"network\.safetensors is missing"):
        rl.load_next(place, net)
    weights.write_bytes(sound)

    content = json.loads(description.read_text())
    for change, sentence in (
        ({"format": 99}, "has format 99"),
        ({"activities": content["activities"][1:]}, "not of one size"),
        ({"scaling": {"minimum": [], "span": []}}, "not of one size"),
        ({"decay": 3}, "is damaged"),
    ):
        description.write_text(json.dumps(content | change))
        with pytest.raises(ModelError, match=sentence):
            rl.load_next(place, net)
    description.write_text("{")
    with pytest.raises(ModelError, match="not JSON"):
        rl.load_next(place, net)


def test_a_place_that_is_taken_stays(trained: rl.NextActivity, tmp_path: Path) -> None:
    (tmp_path / "letter.txt").write_text("dear")
    with pytest.raises(ModelError, match="is no trained network"):
        trained.save(tmp_path)
    assert (tmp_path / "letter.txt").read_text() == "dear"


@pytest.mark.parametrize(
    ("settings", "sentence"),
    [
        ({"epochs": 0}, "epochs is 0"),
        ({"batch": 0}, "batch is 0"),
        ({"learning_rate": 0.0}, "rate"),
    ],
)
def test_settings_that_make_no_sense(
    runs: rl.EventLog, net: rl.PetriNet, settings: dict[str, float], sentence: str
) -> None:
    with pytest.raises(InputError, match=sentence):
        rl.train_next(runs, net, rl.TrainingSettings(**settings))  # type: ignore[arg-type]


def test_nothing_to_learn_from(runs: rl.EventLog, net: rl.PetriNet) -> None:
    with pytest.raises(InputError, match="nothing to learn from"):
        rl.train_next(runs, net, traces=[])
    with pytest.raises(InputError, match="there is no trace 99"):
        rl.train_next(runs, net, traces=[99])


def test_folds_are_contiguous_and_cover_everything() -> None:
    parts = list(folds(7, 3))
    assert [test for _, test in parts] == [[0, 1], [2, 3], [4, 5, 6]]
    assert all(sorted(train + test) == list(range(7)) for train, test in parts)
    for count in (1, 8):
        with pytest.raises(InputError, match="from 2 to 7"):
            next(folds(7, count))
