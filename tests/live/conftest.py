"""A log with a fault, its findings, and a model directory that a test may change."""

import shutil
from pathlib import Path

import pytest

from runglight.log.changelog import Log
from runglight.model import NominalModel
from tests.conftest import simulated


@pytest.fixture(scope="session")
def faulty() -> Log:
    """The cell with fault 1, and the fault is near its beginning."""
    return simulated(seed=2, fault=1)


@pytest.fixture(scope="session")
def offline(nominal_model: NominalModel, faulty: Log) -> list[str]:
    """What watching the log as a file finds."""
    monitor = nominal_model.monitor()
    lines = monitor.observe(faulty).json_lines() + monitor.finish().json_lines()
    assert lines
    return lines


@pytest.fixture
def model_directory(cell: Path, tmp_path: Path) -> Path:
    kept = shutil.ignore_patterns("findings.sqlite*")
    return Path(shutil.copytree(cell / "cell.model", tmp_path / "cell.model", ignore=kept))
