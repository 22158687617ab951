"""Exit codes, and one line for whatever goes wrong."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import Command

Refused = Callable[..., str]


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["lern"], 'Unknown command "lern". Did you mean "learn"?'),
        (["learn", "-o", "m"], "what shall be learned from? name a log"),
        (["learn", "a.csv"], "--output"),
        (["learn", "a.csv", "-o", "m", "--timing", "exact"], '"plat"'),
        (["learn", "a.csv", "-o", "m", "--bogus"], "--bogus"),
        (["learn", "missing.csv", "-o", "m"], "missing.csv: "),
        (["learn", "missing.csv", "-o", "m", "--false-alarms", "often"], "'often' is not a rate"),
        (["learn", "missing.csv", "-o", "m", "--stall-after", "soon"], "'soon' is not a duration"),
        (["learn", "missing.csv", "-o", "m", "--starting", "PrtLDR"], "GROUP-DEVICE=SIGNAL"),
        (["learn", "missing.csv", "-o", "m", "--analog", "Level"], "COLUMN=THRESHOLD"),
        (["learn", "missing.csv", "-o", "m", "--delimiter", "::"], "one character"),
        (["learn", "missing.csv", "-o", "m", "--naming", "{plant}"], "--naming: "),
        (["learn", "missing.csv", "-o", "m", "--symbols", "none.csv"], "none.csv: no such file"),
        (["learn", "missing.csv", "-o", "m", "-c", "none.toml"], "none.toml: no such file"),
        (["show", "missing.model"], "missing.model"),
        (["watch", "missing.model", "a.csv"], "missing.model"),
        (["watch", "missing.model"], "what shall be watched?"),
        (["confirm", "missing.model", "f-1"], "missing.model"),
        (["import", "missing.csv", "--to", "out.csv"], "missing.csv: "),
        (["import", "missing.csv", "--to", "out.pdf"], "out.pdf: cannot tell the format"),
        (["export", "missing.csv", "--to", "out"], "out: cannot tell the format"),
        (["simulate"], "simulate --list"),
        (["simulate", "cel", "--log", "a.csv"], "did you mean cell?"),
        (["simulate", "cell"], "where to?"),
        (["simulate", "cell", "--log", "a.csv", "--fault", "13"], "13"),
        (["simulate", "cell", "--log", "a.csv", "--cycles", "0"], "at least 1 cycle"),
        (["simulate", "cell", "--log", "no/such/directory/a.csv"], "no/such/directory/a.csv"),
        (["demo", "--fault", "99"], "--fault: "),
    ],
)
def test_wrong_use_is_one_line(refused: Refused, arguments: list[str], sentence: str) -> None:
    assert sentence in refused(*arguments)


@pytest.mark.parametrize(
    "url",
    [
        "modbus://plc:502?coils=0-9",
        "s7://plc",
        "opcua://plc:4840",
        "mqtt://broker/topic/#",
        "sparkplug://broker/group",
        "replay:nominal.csv?speed=10",
    ],
)
def test_a_live_source_is_no_log(refused: Refused, url: str) -> None:
    line = refused("learn", url, "-o", "cell.model")
    assert url in line
    assert "runglight record" in line


def test_every_command_is_listed(runglight: Command) -> None:
    helped = runglight("--help")
    assert helped.returncode == 0
    commands = (
        "demo", "init", "check", "simulate", "record", "import", "export", "learn", "show",
        "watch", "confirm", "identify", "mine", "predict", "control", "serve",
    )  # fmt: skip
    for command in commands:
        assert f" {command} " in helped.stdout


@pytest.mark.parametrize("condition", ["fault", "anomaly"])
def test_fail_on(runglight: Command, cell: Path, condition: str) -> None:
    model = cell / "cell.model"
    assert runglight("watch", model, cell / "faulty.csv").returncode == 0
    found = runglight("watch", model, cell / "faulty.csv", "--fail-on", condition)
    assert found.returncode == 1, found
    quiet = runglight("watch", model, cell / "nominal.csv", "--fail-on", condition)
    assert quiet.returncode == 0, quiet


def test_an_unexpected_error_is_a_sentence(tmp_path: Path) -> None:
    program = (
        "import sys\n"
        "import runglight.cli.application as application\n"
        "def broken(arguments): raise ZeroDivisionError('one\\ntwo')\n"
        "application.run = broken\n"
        "from runglight.cli import main\n"
        "sys.exit(main(['demo']))\n"
    )

    def run(debug: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-c", program],
            env=os.environ | {"RUNGLIGHT_DEBUG": debug},
            capture_output=True,
            encoding="utf-8",
            check=False,
        )

    quiet = run("0")
    assert quiet.returncode == 2
    assert quiet.stderr.startswith("runglight: this is a defect of runglight, please report it")
    assert len(quiet.stderr.splitlines()) == 1
    loud = run("1")
    assert loud.returncode == 2
    assert "Traceback" in loud.stderr


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full on this system")
def test_a_full_disk(cell: Path) -> None:
    with Path("/dev/full").open("w") as full:
        ended = subprocess.run(
            [sys.executable, "-m", "runglight", "show", str(cell / "cell.model")],
            stdout=full,
            stderr=subprocess.PIPE,
            encoding="utf-8",
            check=False,
        )
    assert ended.returncode == 2
    assert "the disk is full" in ended.stderr
    assert len(ended.stderr.splitlines()) == 1


def test_a_broken_pipe_is_quiet(cell: Path) -> None:
    command = [sys.executable, "-m", "runglight", "show", str(cell / "cell.model")]
    reading, writing = os.pipe()
    os.close(reading)
    ended = subprocess.run(
        [*command, "--format", "csv"],
        stdout=writing,
        stderr=subprocess.PIPE,
        encoding="utf-8",
        check=False,
    )
    os.close(writing)
    assert ended.stderr == ""
    assert ended.returncode == 0


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="root may write everywhere")
def test_no_permission(runglight: Command, cell: Path, tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    ended = runglight("show", cell / "cell.model", "-o", tmp_path / "model.txt")
    tmp_path.chmod(0o700)
    assert ended.returncode == 2
    assert "permission denied" in ended.stderr


def test_ctrl_c(tmp_path: Path) -> None:
    program = (
        "import sys, time\n"
        "import runglight.cli.application as application\n"
        "def slow(arguments):\n"
        "    print('started', flush=True)\n"
        "    time.sleep(60)\n"
        "application.run = slow\n"
        "from runglight.cli import main\n"
        "sys.exit(main(['demo']))\n"
    )
    running = subprocess.Popen(
        [sys.executable, "-c", program],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        encoding="utf-8",
    )
    assert running.stdout is not None
    assert running.stdout.readline() == "started\n"
    time.sleep(0.05)
    running.send_signal(signal.SIGINT)
    _, said = running.communicate(timeout=300)
    assert running.returncode == 130
    assert said == "runglight: interrupted\n"


def test_a_terminal_that_knows_no_arrows(runglight: Command, cell: Path) -> None:
    ended = runglight(
        "watch",
        cell / "cell.model",
        cell / "faulty.csv",
        environment={"PYTHONIOENCODING": "latin-1", "PYTHONUTF8": "0"},
    )
    assert ended.returncode == 0, ended.stderr


def test_version(runglight: Command) -> None:
    import runglight as package  # noqa: PLC0415

    assert runglight("--version").stdout.strip() == package.__version__
