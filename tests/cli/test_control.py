"""`runglight control` as a user runs it: tank, program and learned controller as processes."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from pymodbus.client import ModbusTcpClient

from runglight.log.changelog import Log
from runglight.plants.tank import simulate_tank
from tests.conftest import Command
from tests.control.nets import FIGURE_5, FIGURE_7, write_net

FILLING = [True, False]
PATIENCE_S = 120
"""A guard against hanging, on a slow build server."""


@contextmanager
def process(*arguments: str) -> Iterator[subprocess.Popen[str]]:
    """A runglight that works beside the test."""
    started = subprocess.Popen(
        [sys.executable, "-m", "runglight", *arguments],
        env=os.environ | {"CI": "true", "COLUMNS": "160"},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        encoding="utf-8",
    )
    try:
        yield started
    finally:
        started.kill()
        started.communicate()


@contextmanager
def tank() -> Iterator[tuple[str, ModbusTcpClient]]:
    """A served tank without a controller: its address, and a client that looks on."""
    with process("simulate", "tank", "--serve", "modbus://127.0.0.1:0") as served:
        assert served.stdout is not None
        line = served.stdout.readline()
        assert line.startswith("tank: serving at "), line
        url = line.removeprefix("tank: serving at ").strip()
        client = ModbusTcpClient("127.0.0.1", port=urlsplit(url).port or 0, timeout=30)
        assert client.connect()
        yield url, client
        client.close()


def wait_for(client: ModbusTcpClient, coils: list[bool]) -> None:
    """Until the valves stand so."""
    until = time.monotonic() + PATIENCE_S
    while client.read_coils(0, count=2).bits[:2] != coils:
        assert time.monotonic() < until, f"the valves never stood at {coils}"
        time.sleep(0.05)


@pytest.fixture
def figure_5(tmp_path: Path) -> Path:
    """The net of the first program."""
    return write_net(tmp_path / "c1.pnml", FIGURE_5, "p8")


@pytest.fixture
def figure_7(tmp_path: Path) -> Path:
    """The net of the second program."""
    return write_net(tmp_path / "c2.pnml", FIGURE_7, "p9")


@pytest.fixture
def log(tmp_path: Path) -> Path:
    """A log of the second program."""
    run = simulate_tank("2")
    path = tmp_path / "tank.csv"
    Log.from_columns(run.time_ns, run.signal_index, run.value, run.signals).write(path)
    return path


def test_the_learned_controller_is_swapped_for_the_program(figure_5: Path) -> None:
    with tank() as (url, client):
        with process("simulate", "program", "c1", "--plant", url) as program:
            wait_for(client, FILLING)
            program.send_signal(signal.SIGINT)
            assert program.wait(PATIENCE_S) == 130
        # A PLC that stops switches its outputs off.
        assert client.read_coils(0, count=2).bits[:2] == [False, False]
        with process("control", str(figure_5), "--plant", url, "--allow-writes") as control:
            wait_for(client, FILLING)
            control.send_signal(signal.SIGINT)
            out, error = control.communicate(timeout=PATIENCE_S)
        assert control.returncode == 130
        assert out == ""
        assert "will write %QX0.0 (coil 0), %QX0.1 (coil 1)" in error
        assert "safe state, also at the end: %QX0.0=0, %QX0.1=0" in error
        assert client.read_coils(0, count=2).bits[:2] == [False, False]


def test_a_shadow_writes_nothing(figure_5: Path) -> None:
    with tank() as (url, client):
        with process("control", str(figure_5), "--plant", url, "--shadow", "--for", "3s") as shadow:
            out, error = shadow.communicate(timeout=PATIENCE_S)
        # Nobody opens the valve: the learned controller would have.
        assert shadow.returncode == 1
        assert "%QX0.0=1 & %QX0.1=0 did not come" in " ".join(out.split())
        assert "nothing is written" in error
        assert "1 disagreement" in error
        assert client.read_coils(0, count=2).bits[:2] == [False, False]


def test_nothing_is_written_that_was_not_allowed(runglight: Command, figure_5: Path) -> None:
    for arguments, sentence in (
        (["--plant", "modbus://127.0.0.1:1"], "add --allow-writes, or --shadow"),
        (["--plant", "modbus://192.0.2.7", "--allow-writes"], "--i-know-this-moves-machinery"),
        (["--plant", "modbus://127.0.0.1:1", "--allow-writes", "--shadow"], "leave out --allow"),
        (["--plant", "s7://127.0.0.1", "--allow-writes"], "over modbus, not over s7"),
        ([], "at which plant?"),
        (["--plant", "modbus://127.0.0.1", "--safe", "%QX0.0"], "write %QX0.0=0"),
        (
            ["--plant", "modbus://127.0.0.1", "--safe", "%QX9.0=1", "--allow-writes"],
            '"%QX9.0" is no output of the net',
        ),
    ):
        result = runglight("control", figure_5, *arguments)
        assert result.returncode == 2
        assert sentence in result.stderr
        assert len(result.stderr.splitlines()) == 1


def test_guards_are_learned_told_and_exported(
    runglight: Command, figure_7: Path, log: Path, tmp_path: Path
) -> None:
    refused = runglight("control", figure_7, "--st", "tank.st")
    assert refused.returncode == 2
    assert 'does not say what comes after "%IX0.2=0"' in refused.stderr
    learned = runglight("control", "learn", log, "--net", figure_7, "-o", "guards.json")
    assert learned.returncode == 0, learned.stderr
    assert learned.stdout.splitlines()[0] == (
        "after %IX0.2=0: set %QX0.0=1 & %QX0.1=0; once %IX0.2=0 has come 3 times in this run, wait"
    )
    assert json.loads((tmp_path / "guards.json").read_text())["format"] == 1
    written = runglight(
        "control", figure_7, "--guards", "guards.json", "--st", "tank.st", "--safe", "%QX0.1=1"
    )
    assert written.returncode == 0, written.stderr
    text = (tmp_path / "tank.st").read_text()
    assert "PROGRAM tank\n" in text
    assert "count_0 : CTU;" in text


def test_files_that_are_no_guards(runglight: Command, figure_7: Path, tmp_path: Path) -> None:
    (tmp_path / "no.json").write_text("[]")
    for name, sentence in (("no.json", "these are no guards"), ("gone.json", "no guards here")):
        result = runglight("control", figure_7, "--guards", name, "--st", "x.st")
        assert result.returncode == 2
        assert sentence in result.stderr


def test_the_tank_as_a_log(runglight: Command, tmp_path: Path) -> None:
    result = runglight("simulate", "tank", "--scenario", "3", "--log", "tank.csv", "--for", "100s")
    assert result.returncode == 0, result.stderr
    assert "%IX0.1" in (tmp_path / "tank.csv").read_text()
    for arguments, sentence in (
        (["tank", "--scenario", "4", "--log", "x.csv"], "there is no scenario '4'; it has 1, 2, 3"),
        (["tank", "--cycles", "4", "--log", "x.csv"], "this plant has no --cycles"),
        (["cell", "--scenario", "1", "--log", "x.csv"], "this plant has no --scenario"),
        (["program", "c3", "--plant", "modbus://127.0.0.1"], "there is no program 'c3'"),
        (["program", "c1", "--plant", "modbus://192.0.2.7"], "writes to this computer alone"),
    ):
        refused = runglight("simulate", *arguments)
        assert refused.returncode == 2
        assert sentence in refused.stderr, refused.stderr
