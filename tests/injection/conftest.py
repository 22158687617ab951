"""One clean log and its model, which many injections start from."""

import pytest

from runglight.log.changelog import Log
from runglight.model import NominalModel, learn
from tests.conftest import simulated


@pytest.fixture(scope="session")
def clean() -> Log:
    """Sixty cycles of the cell."""
    return simulated(cycles=60)


@pytest.fixture(scope="session")
def model(clean: Log) -> NominalModel:
    """What is nominal in them."""
    return learn(clean)
