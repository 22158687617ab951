"""A served directory with a learned cell, a faulty log and its findings."""

import shutil
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from runglight.findings.store import FindingStore
from runglight.log.changelog import read_log
from runglight.model import load_model
from runglight.server.application import application
from runglight.server.policy import Policy, policy
from runglight.server.workshop import Workshop
from tests.server.photographed import Photographed, photographed

with warnings.catch_warnings():
    # Starlette would rather have a successor of httpx that has yet to settle.
    warnings.simplefilter("ignore")
    from starlette.testclient import TestClient

COMMAND = {"x-runglight": "test"}
Serving = Callable[..., object]


@pytest.fixture
def directory(cell: Path, tmp_path: Path) -> Path:
    """`cell.model` with the findings of `faulty.csv`, both logs, the symbols, a configuration."""
    target = tmp_path / "served"
    shutil.copytree(cell, target)
    model = load_model(target / "cell.model")
    monitor = model.monitor()
    lines = monitor.observe(read_log(target / "faulty.csv")).json_lines()
    lines += monitor.finish().json_lines()
    with FindingStore(target / "cell.model") as store:
        store.append(lines, monitor.take_snapshots())
    (target / "runglight.toml").write_text(
        '[notify]\npublish = "mqtt://cell:hunter22@broker/cell"\n', encoding="utf-8"
    )
    return target


@contextmanager
def serving(directory: Path, chosen: Policy | None = None) -> Iterator[TestClient]:
    """A client of a server of a directory, as a page of its own would ask."""
    workshop = Workshop(directory, chosen or policy())
    with TestClient(application(workshop), base_url="http://127.0.0.1:8470") as client:
        yield client


@pytest.fixture(scope="session")
def machine(tmp_path_factory: pytest.TempPathFactory) -> Photographed:
    """The bottling machine with its photos; whoever writes into it copies it first."""
    return photographed(tmp_path_factory.mktemp("identify") / "line3")


@pytest.fixture
def client(directory: Path) -> Iterator[TestClient]:
    with serving(directory) as client:
        client.headers.update(COMMAND)
        yield client
