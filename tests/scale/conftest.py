"""One Spark cluster and one Kafka broker for all tests of this folder."""

from __future__ import annotations

import importlib.util
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from tests.scale import needed
from tests.scale.broker import Broker, running
from tests.scale.sessions import CLUSTER, end, new_session

if TYPE_CHECKING:
    from pyspark.sql import SparkSession


UNCLOSED = "ignore::pytest.PytestUnraisableExceptionWarning"
"""py4j leaves the sockets of its threads to the collector."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Marks the tests that use Spark."""
    for item in items:
        if "spark" in getattr(item, "fixturenames", ()):
            item.add_marker(pytest.mark.filterwarnings(UNCLOSED))


@pytest.fixture(scope="package")
def spark(tmp_path_factory: pytest.TempPathFactory) -> Iterator[SparkSession]:
    """A driver and two executors, each a Java machine of its own."""
    if (missing := needed.missing_for_spark()) is not None:
        pytest.skip(missing)
    try:
        jars = needed.jars("connector")
    except FileNotFoundError:
        # Whatever needs no topic is tested all the same.
        jars = []
    session = new_session(CLUSTER, tmp_path_factory.mktemp("spark"), jars)
    try:
        yield session
    finally:
        end(session)


@pytest.fixture(scope="package")
def broker(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Broker]:
    """A Kafka broker."""
    if (missing := needed.missing_for_spark()) is not None:
        pytest.skip(missing)
    if importlib.util.find_spec("confluent_kafka") is None:
        pytest.skip('confluent-kafka is not installed: pip install "runglight[kafka]"')
    try:
        jars = needed.jars("broker")
        needed.jars("connector")
    except FileNotFoundError as error:
        pytest.skip(str(error))
    with running(jars, tmp_path_factory.mktemp("kafka")) as broker:
        yield broker


@pytest.fixture
def checkpoint(tmp_path: Path) -> str:
    """A directory that a watch goes on from."""
    return str(tmp_path / "checkpoint")
