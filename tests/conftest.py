"""The command as a user runs it, and one learned cell that many tests look at."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from runglight.log.changelog import Log
from runglight.model import NominalModel, learn
from runglight.plants import PLANTS, write_symbols

Command = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture
def runglight(tmp_path: Path) -> Command:
    """Runs `runglight ARGUMENTS…` in an empty directory."""

    def run(
        *arguments: str | Path, environment: dict[str, str] | None = None
    ) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-m", "runglight", *map(str, arguments)],
            cwd=tmp_path,
            env=os.environ | {"CI": "true", "COLUMNS": "160"} | (environment or {}),
            stdin=subprocess.DEVNULL,
            capture_output=True,
            encoding="utf-8",
            errors="replace",
            timeout=900,
            check=False,
        )

    return run


@pytest.fixture
def refused(runglight: Command) -> Callable[..., str]:
    """Runs a command that must end with code 2 and one line; returns that line."""

    def run(*arguments: str | Path, environment: dict[str, str] | None = None) -> str:
        ended = runglight(*arguments, environment=environment)
        lines = ended.stderr.splitlines()
        assert ended.returncode == 2, ended
        assert len(lines) == 1, ended.stderr
        assert lines[0].startswith("runglight: ")
        assert "Traceback" not in ended.stderr
        return lines[0]

    return run


def simulated(cycles: int = 20, seed: int = 1, fault: int | None = None) -> Log:
    """A log of the simulated cell."""
    run = PLANTS["cell"].simulate(
        cycles=None if fault is not None else cycles, seed=seed, fault=fault
    )
    return Log.from_columns(run.time_ns, run.signal_index, run.value, run.signals)


@pytest.fixture(scope="session")
def cell(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """`nominal.csv`, `faulty.csv` (fault 1), `symbols.csv` and `cell.model` of the cell."""
    directory = tmp_path_factory.mktemp("cell")
    simulated().write(directory / "nominal.csv")
    simulated(seed=2, fault=1).write(directory / "faulty.csv")
    write_symbols(PLANTS["cell"].symbols, directory / "symbols.csv")
    learn(simulated(), symbols=directory / "symbols.csv").save(directory / "cell.model")
    return directory


@pytest.fixture(scope="session")
def nominal_model(cell: Path) -> NominalModel:
    """The cell, learned from twenty cycles."""
    return learn(simulated(), symbols=cell / "symbols.csv")
