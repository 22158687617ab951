"""The cycle machine on the command line: learn with [modes], watch, show --cycle and --region."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import Command

CONFIGURATION = """
[symbols]
table = "symbols.csv"

[modes]
work_complete = "M0.0"
manual = "M0.1"
alarm = ["M0.2"]

[regions]
clamps = "I12-I13 by byte"
punches = ["I14.0", "I14.1", "I14.2", "I14.3"]
"""


@pytest.fixture
def press(runglight: Command, tmp_path: Path) -> Path:
    written = runglight(
        "simulate", "press", "--cycles", "30", "--log", "nominal.csv", "--symbols", "symbols.csv"
    )
    assert written.returncode == 0, written.stderr
    (tmp_path / "runglight.toml").write_text(CONFIGURATION, encoding="utf-8")
    learned = runglight("learn", "nominal.csv", "-o", "press.model")
    assert learned.returncode == 0, learned.stderr
    assert "cycle machine" in learned.stdout
    assert "M0.0, M0.1, M0.2 say what the machine is about" in learned.stderr
    return tmp_path / "press.model"


def test_regions_and_machines(press: Path, runglight: Command) -> None:
    assert (press / "cycles.json").is_file()
    table = runglight("show", press, "--cycle")
    assert table.returncode == 0
    assert all(name in table.stdout for name in ("clamps-I12", "clamps-I13", "punches"))
    regions = json.loads(runglight("show", press, "--cycle", "--format", "json").stdout)
    assert [region["region"] for region in regions["regions"]] == [
        "clamps-I12",
        "clamps-I13",
        "punches",
    ]
    machine = json.loads(
        runglight("show", press, "--region", "clamps-I13", "--format", "json").stdout
    )
    words = {state["word"] for state in machine["states"]}
    assert {"0a", "05"} <= words
    rows = runglight("show", press, "--region", "clamps-I13", "--format", "csv").stdout
    assert rows.splitlines()[0] == "from,to,weight,longest_stay_s"
    assert len(rows.splitlines()) == len(machine["transitions"]) + 1


def test_drawings_have_the_colours_of_the_paper(press: Path, runglight: Command) -> None:
    dot = runglight("show", press, "--region", "clamps-I13", "--format", "dot").stdout
    assert dot.startswith("digraph")
    assert "#2f6fdb" in dot
    assert "#c0392b" in dot
    setup = runglight(
        "show", press, "--region", "clamps-I13", "--phase", "setup", "--format", "dot"
    ).stdout
    assert setup != dot


def test_a_failure_is_named_by_its_address(press: Path, runglight: Command) -> None:
    runglight("simulate", "press", "--fault", "clamp2-adv-dead", "--log", "broken.csv")
    watched = runglight("watch", press, "broken.csv", "--format", "jsonl", "--fail-on", "fault")
    assert watched.returncode == 1, watched.stderr
    findings = [json.loads(line) for line in watched.stdout.splitlines()]
    [cause] = [finding for finding in findings if finding["rank"] == 1]
    assert (cause["model"], cause["suspects"][0]["address"]) == ("cycle", "I12.2")


def test_the_table_tells_class_and_suspects(press: Path, runglight: Command) -> None:
    runglight("simulate", "press", "--fault", "clamp2-adv-dead", "--log", "broken.csv")
    table = runglight("watch", press, "broken.csv").stdout
    assert "class 1" in table
    assert "Suspects: I12.2 Clamp2-ADV" in table


def test_refusals(press: Path, runglight: Command, refused: Callable[..., str]) -> None:
    assert "has no region 'clamp-I12'" in refused("show", press, "--region", "clamp-I12")
    assert "add --region" in refused("show", press, "--cycle", "--format", "svg")
    assert "leave --device" in refused("show", press, "--cycle", "--device", "Clamp1")
    Path(press.parent, "runglight.toml").write_text("", encoding="utf-8")
    runglight("learn", "nominal.csv", "-o", "plain.model")
    assert "no cycle machine" in refused("show", "plain.model", "--cycle")
