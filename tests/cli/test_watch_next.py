"""`runglight watch --next`: what the network thought very unlikely is told, never as an alarm."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import Command
from tests.process.counting_tank import RESET, changes, write_net

Happened = list[tuple[float, list[tuple[str, int]]]]

WATCH = ("watch", "tank.model", "today.csv", "--next", "tank.next", "--net", "tank.pnml")


def write_csv(path: Path, happened: Happened) -> None:
    rows = [f"{round(t * 1000)},{signal},{value}" for t, what in happened for signal, value in what]
    path.write_text("\n".join(["time,signal,value", *rows]) + "\n", encoding="utf-8")


def counted_wrong() -> Happened:
    """The fifth run is filled twice instead of three times."""
    happened = changes(4)[:-1]
    for part in (changes(1, fillings=2)[1:-1], changes(3)[1:]):
        start = happened[-1][0] - part[0][0] + 4.4
        happened += [(start + time, what) for time, what in part]
    return happened


@pytest.fixture
def tank(runglight: Command, tmp_path: Path) -> None:
    """Model, network and net of sound runs; `today.csv`, in which one fills too few times."""
    write_csv(tmp_path / "tank.csv", changes(22))
    write_csv(tmp_path / "today.csv", counted_wrong())
    write_net(tmp_path / "tank.pnml")
    assert runglight("learn", "tank.csv", "-o", "tank.model").returncode == 0
    trained = ("predict", "train", "tank.csv", "--net", "tank.pnml", "--reset", RESET)
    assert runglight(*trained, "-o", "tank.next").returncode == 0


def of_network(told: str) -> list[dict[str, object]]:
    return [line for line in map(json.loads, told.splitlines()) if line["model"] == "process"]


@pytest.mark.usefixtures("tank")
def test_a_run_that_counts_wrong_is_a_notice(runglight: Command) -> None:
    watched = runglight(*WATCH, "--format", "jsonl")
    assert watched.returncode == 0, watched.stderr
    [first, *_] = told = of_network(watched.stdout)
    assert (first["to"], first["kind"]) == (RESET, "transition")
    assert {line["severity"] for line in told} == {"notice"}
    assert of_network(runglight(*WATCH[:3], "--format", "jsonl").stdout) == []


@pytest.mark.usefixtures("tank")
def test_two_logs_are_watched_as_one(runglight: Command, tmp_path: Path) -> None:
    whole = of_network(runglight(*WATCH, "--format", "jsonl").stdout)
    assert whole
    happened = counted_wrong()
    told = []
    for part in (happened[:90], happened[90:]):
        write_csv(tmp_path / "today.csv", part)
        watched = runglight(*WATCH, "--format", "jsonl", "--state", "kept")
        told += of_network(watched.stdout)
    # The last scan stays open.
    assert [line["id"] for line in told] == [line["id"] for line in whole]


@pytest.mark.usefixtures("tank")
def test_what_cannot_be_watched_so_is_refused(refused: Callable[..., str]) -> None:
    assert "--net NET" in refused(*WATCH[:5])
    assert "give that with --next" in refused(*WATCH[:3], "--net", "tank.pnml")
    assert "between 0 and 1" in refused(*WATCH, "--unlikely", "1.5")
    live = ("watch", "tank.model", "modbus://127.0.0.1?inputs=0-7", *WATCH[3:])
    assert "is a live source" in refused(*live)
