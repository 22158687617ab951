"""The state of the monitor on disk."""

from pathlib import Path

from runglight.live.checkpoint import Checkpoint
from runglight.log.changelog import Log
from runglight.model import NominalModel, learn
from tests.conftest import simulated


def test_a_state_is_gone_on_from(nominal_model: NominalModel, faulty: Log, tmp_path: Path) -> None:
    checkpoint = Checkpoint(tmp_path / "cell.state")
    monitor, afresh = checkpoint.restore(nominal_model)
    assert (monitor.now_ns, afresh) == (None, None)
    monitor.observe(faulty.slice(0, 100))
    checkpoint.save(monitor.state())
    restored, afresh = checkpoint.restore(nominal_model)
    assert afresh is None
    assert restored.state() == monitor.state()
    assert [path.name for path in tmp_path.iterdir()] == ["cell.state"]


def test_no_machine_is_left_unwatched_for_a_state(
    nominal_model: NominalModel, tmp_path: Path
) -> None:
    checkpoint = Checkpoint(tmp_path / "cell.state")
    other = learn(simulated(cycles=3, seed=9))
    for state, why in ((other.monitor().state(), "another model"), (b"junk", "damaged")):
        checkpoint.save(state)
        monitor, afresh = checkpoint.restore(nominal_model)
        assert monitor.now_ns is None
        assert afresh is not None
        assert why in afresh
        assert "starts afresh" in afresh
