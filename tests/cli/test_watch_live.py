"""`runglight watch MODEL URL` as a user and a service manager run it."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from runglight.findings.store import FindingStore
from tests.conftest import Command

GUARD_S = 600


@pytest.fixture
def model(cell: Path, tmp_path: Path) -> Path:
    kept = shutil.ignore_patterns("findings.sqlite*")
    return Path(shutil.copytree(cell / "cell.model", tmp_path / "cell.model", ignore=kept))


@pytest.mark.parametrize("format", ["jsonl", "csv"])
def test_a_replay_finds_what_the_file_has(
    runglight: Command, cell: Path, model: Path, format: str
) -> None:
    file = cell / "faulty.csv"
    as_log = runglight("watch", model, file, "--format", format)
    live = runglight("watch", model, f"replay:{file}?speed=max", "--format", format)
    assert live.returncode == 0, live.stderr
    assert live.stdout == as_log.stdout
    assert len(live.stdout.splitlines()) >= 3
    assert not live.stderr


def test_people_are_told_when_where_what_and_what_next(
    runglight: Command, cell: Path, model: Path
) -> None:
    live = runglight("watch", model, f"replay:{cell / 'faulty.csv'}?speed=max")
    told = live.stdout.splitlines()
    assert told[0].startswith("2026-01-05 06:05:13.240  FAULT   Group1-PrtLDR")
    assert "Expected: RET_ON" in told[1]
    assert "Look first at Group1-PrtLDR, signal PRT_CHK, address %IX0.2" in told[2]
    assert any("returned" in line for line in told)
    # No status line where nobody sees it.
    assert "\x1b" not in live.stdout + live.stderr


def test_fail_on(runglight: Command, cell: Path, model: Path) -> None:
    faulty, nominal = (f"replay:{cell / name}.csv?speed=max" for name in ("faulty", "nominal"))
    assert runglight("watch", model, faulty, "--fail-on", "fault").returncode == 1
    assert runglight("watch", model, nominal, "--fail-on", "anomaly").returncode == 0


def test_the_configuration_says_it_all(
    runglight: Command, cell: Path, model: Path, tmp_path: Path
) -> None:
    (tmp_path / "runglight.toml").write_text(
        f"[source]\nurl = 'replay:{cell / 'faulty.csv'}?speed=max'\n"
        "[watch]\nformat = 'jsonl'\nrecord = 'rec'\nstate = 'cell.state'\nduration = '60s'\n"
        "store = 'sqlite:///copy.db'\noutput = 'findings.jsonl'\n[server]\nmetrics = '0'\n",
        encoding="utf-8",
    )
    watched = runglight("watch", model)
    assert watched.returncode == 0, watched.stderr
    assert (tmp_path / "cell.state").exists()
    assert (tmp_path / "copy.db").exists()
    assert (tmp_path / "findings.jsonl").read_text(encoding="utf-8")
    # The recording is a log like any other.
    arguments = ("--format", "jsonl", "-o", "again.jsonl", "--state", "other.state")
    again = runglight("watch", model, "rec", *arguments)
    assert again.returncode == 0, again.stderr


def test_what_is_wrong_is_one_sentence(
    refused: Callable[..., str], cell: Path, model: Path
) -> None:
    replay = f"replay:{cell / 'nominal.csv'}?speed=max"
    assert "--metrics" in refused("watch", model, replay, "--metrics", "host")
    assert "--webhook" in refused("watch", model, replay, "--webhook", "host")
    assert "--publish" in refused("watch", model, replay, "--publish", "mqtt://host")
    assert "--store" in refused("watch", model, replay, "--store", "mysql://host/x")
    assert "--for" in refused("watch", model, replay, "--for", "soon")
    assert "--record: is for live sources" in refused(
        "watch", model, cell / "nominal.csv", "--record", "rec"
    )
    assert "unknown option 'sped'" in refused("watch", model, f"replay:{cell}?sped=1")


class Started:
    """A `watch` that runs until a test ends it."""

    def __init__(self, directory: Path, *arguments: str | Path) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", "runglight", "watch", *map(str, arguments)],
            cwd=directory,
            env=os.environ | {"CI": "true"},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            encoding="utf-8",
        )

    def end(self, how: signal.Signals) -> tuple[int, str, str]:
        self.process.send_signal(how)
        stdout, stderr = self.process.communicate(timeout=GUARD_S)
        return self.process.returncode, stdout, stderr


def kept(model: Path) -> list[str]:
    with FindingStore(model, create=False) as store:
        return [each.line for each in store.after(0, 1000)]


def wait_for(what: Callable[[], bool]) -> None:
    deadline = time.monotonic() + GUARD_S
    while not what():
        assert time.monotonic() < deadline
        time.sleep(0.05)


@pytest.mark.parametrize(("how", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 0)])
def test_an_interruption_keeps_everything(
    cell: Path, model: Path, tmp_path: Path, how: signal.Signals, code: int
) -> None:
    # The fault is five minutes into the log.
    url = f"replay:{cell / 'faulty.csv'}?speed=300"
    started = Started(
        tmp_path, model, url, "--format", "jsonl", "--state", "cell.state", "--record", "rec"
    )
    assert started.process.stdout is not None
    first = started.process.stdout.readline()
    ended, rest, stderr = started.end(how)
    assert ended == code, stderr
    assert not stderr
    assert (tmp_path / "cell.state").exists()
    assert kept(model) == (first + rest).splitlines()


def test_killed_and_started_again_tells_nothing_twice(
    cell: Path, model: Path, tmp_path: Path
) -> None:
    (tmp_path / "runglight.toml").write_text("[watch]\ncheckpoint_every_s = 0.2\n", "utf-8")
    url = f"replay:{cell / 'faulty.csv'}?speed=300"
    arguments = (model, url, "--format", "jsonl", "--state", "cell.state")
    for _ in range(3):
        started = Started(tmp_path, *arguments)
        assert started.process.stdout is not None
        assert started.process.stdout.readline()
        wait_for(lambda: (tmp_path / "cell.state").exists() and bool(kept(model)))
        started.end(signal.SIGKILL)
    lines = [json.loads(line) for line in kept(model)]
    told = [(line["id"], line["state"]) for line in lines]
    assert told
    assert len(told) == len(set(told))
