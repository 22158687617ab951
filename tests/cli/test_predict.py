"""`runglight predict`: of the counting tank only a network knows when it empties."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import Command

RESET = ("--reset", "%IX0.1=0")


@pytest.fixture
def tank(runglight: Command) -> None:
    """`tank.csv` and its net `tank.pnml`, 22 runs."""
    simulated = ("simulate", "tank", "--scenario", "2", "--for", "880s", "--log", "tank.csv")
    assert runglight(*simulated).returncode == 0
    assert runglight("mine", "tank.csv", *RESET, "-o", "tank.pnml").returncode == 0


def shares(told: str) -> dict[str, float]:
    """Accuracy in per cent by what foretold."""
    rows = re.findall(r"^ *(\S.*?) +[\d,]+ +[\d,]+ +([\d.]+) %", told, re.MULTILINE)
    return {name.strip(): float(share) for name, share in rows}


@pytest.mark.usefixtures("tank")
def test_the_network_counts_what_the_last_activities_do_not_tell(runglight: Command) -> None:
    evaluated = runglight("predict", "evaluate", "tank.csv", "--net", "tank.pnml", *RESET)
    assert evaluated.returncode == 0, evaluated.stderr
    told = shares(evaluated.stdout)
    assert told["network"] == 100.0
    assert told["after the last one"] < 95.0
    assert told["commonest activity"] < told["after the last one"]


@pytest.mark.usefixtures("tank")
def test_a_trained_network_is_kept_and_used_again(runglight: Command, tmp_path: Path) -> None:
    train = ("predict", "train", "tank.csv", "--net", "tank.pnml", *RESET, "-o")
    assert runglight(*train, "next").returncode == 0
    assert runglight(*train, "again").returncode == 0
    files = sorted(path.name for path in (tmp_path / "next").iterdir())
    assert any(name.endswith(".safetensors") for name in files)
    for name in files:
        if name.endswith(".safetensors"):
            same = (tmp_path / "again" / name).read_bytes()
            assert (tmp_path / "next" / name).read_bytes() == same
    use = ("predict", "evaluate", "tank.csv", "--net", "tank.pnml", "--next", "next")
    assert shares(runglight(*use).stdout)["network"] == 100.0


@pytest.mark.usefixtures("tank")
def test_what_is_no_network_of_this_net_is_refused(
    runglight: Command, refused: Callable[..., str], tmp_path: Path
) -> None:
    train = ("predict", "train", "tank.csv", "--net", "tank.pnml", *RESET, "--epochs", "1")
    assert runglight(*train, "-o", "next").returncode == 0
    use = ("predict", "evaluate", "tank.csv", "--next", "next", "--net")
    only = ("mine", "tank.csv", *RESET, "--only", "%IX0.1,%QX0.0", "-o", "other.pnml")
    assert runglight(*only).returncode == 0
    assert "net" in refused(*use, "other.pnml")
    weights = next((tmp_path / "next").glob("*.safetensors"))
    weights.write_bytes(weights.read_bytes()[:-7])
    refused(*use, "tank.pnml")
    assert "--epochs" in refused(*train[:-1], "0", "-o", "none")
