"""`runglight mine`: what it prints and writes."""

from collections.abc import Callable
from pathlib import Path

import runglight as rl
from tests.conftest import Command
from tests.process.test_event_log import RUN, tank


def test_an_io_log_is_mined(runglight: Command, tmp_path: Path) -> None:
    tank().write(tmp_path / "tank.csv")
    files = ["-o", "net.pnml", "--xes", "runs.xes", "--bpmn", "net.bpmn"]
    mined = runglight("mine", "tank.csv", "--reset", "%IX0.1=0", *files)
    assert mined.returncode == 0, mined.stderr
    assert mined.stdout.splitlines() == [
        "Runs        1 trace of 5 events, 5 activities",
        "Net         6 places, 5 transitions, 0 of them silent",
        "Sound       yes",
        "Fitness     1.0000, 1 of 1 trace fit",
        "Precision   1.0000",
    ]
    assert rl.read_event_log(tmp_path / "runs.xes").sequences() == [RUN]
    assert [t.label for t in rl.read_net(tmp_path / "net.pnml").transitions] == RUN
    again = runglight("mine", "runs.xes")
    assert again.stdout == mined.stdout
    partial = runglight("mine", "tank.csv", "--reset", "%IX0.1=0", "--keep-partial")
    assert partial.stdout.startswith("Runs        3 traces of ")


def test_the_configuration_names_the_reset(runglight: Command, tmp_path: Path) -> None:
    tank().write(tmp_path / "tank.csv")
    (tmp_path / "runglight.toml").write_text(
        '[process]\nreset = "%IX0.1=0"\nonly = ["%IX0.1"]\n', encoding="utf-8"
    )
    mined = runglight("mine", "tank.csv")
    assert mined.stdout.startswith("Runs        1 trace of 2 events, 2 activities\n")


def test_what_cannot_be_mined_is_said(refused: Callable[..., str], tmp_path: Path) -> None:
    tank().write(tmp_path / "tank.csv")
    assert "--reset %IX0.1=0" in refused("mine", "tank.csv")
    assert "no signal 'X'" in refused("mine", "tank.csv", "--reset", "X=1")
    assert "eta" in refused("mine", "tank.csv", "--reset", "%IX0.1=0", "--eta", "3")
    assert "what shall be mined?" in refused("mine")


def test_xes_is_imported_whatever_its_ending(runglight: Command, tmp_path: Path) -> None:
    rl.EventLog.from_traces([["a", "b"]]).write(tmp_path / "runs.xml")
    imported = runglight("import", "runs.xml", "--to", "log.csv", "--xes")
    assert imported.returncode == 0, imported.stderr
    assert imported.stdout == "log.csv: 4 rows of 2 signals\n"
