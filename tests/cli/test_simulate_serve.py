"""`runglight simulate cell --serve …` as a user runs it, read by real clients."""

import json
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from pymodbus.client import ModbusTcpClient
from snap7.client import Client
from snap7.type import Area

from runglight.log.symbols import read_symbols
from runglight.plants import PLANTS
from tests.conftest import Command

AT_START = [True, False, False, True, True] + [False] * 2 + [True]
"""Home: the loader, both clamps open, robot 1."""


class Served:
    """A running `simulate --serve`."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self.process = process
        self.lines: list[str] = []

    def read_until(self, words: str) -> str:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.lines.append(line.strip())
            if words in line:
                return line.strip()
        raise AssertionError(f"never said {words!r}: {self.lines}")

    def tap_url(self) -> str:
        return self.read_until("tap it with: ").removeprefix("tap it with: ")

    def end(self, with_signal: signal.Signals) -> tuple[int, str]:
        self.process.send_signal(with_signal)
        out, error = self.process.communicate(timeout=300)
        self.lines += out.splitlines()
        return self.process.returncode, error


@pytest.fixture
def simulate(tmp_path: Path) -> Callable[..., object]:
    @contextmanager
    def run(*arguments: str) -> Iterator[Served]:
        process = subprocess.Popen(
            [sys.executable, "-m", "runglight", "simulate", "cell", *arguments],
            cwd=tmp_path,
            env=os.environ | {"CI": "true", "COLUMNS": "160"},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            encoding="utf-8",
        )
        try:
            yield Served(process)
        finally:
            process.kill()
            process.communicate()

    return run


def test_modbus_and_a_clean_end_by_interrupt(simulate: Command, tmp_path: Path) -> None:
    with simulate(
        *["--serve", "modbus://127.0.0.1:0", "--symbols", "symbols.csv", "--labels", "labels.json"],
        *["--fault", "3", "--after", "60s", "--fault", "forward-dead", "--after", "2m"],
    ) as served:
        url = urlsplit(served.tap_url())
        assert url.query == "inputs=0-15&coils=0-12&names=openplc&interval=10ms"
        served.read_until("fault 3 open-decelerated: to begin at the next possible moment after 60")
        served.read_until("fault 5 forward-dead: to begin at the next possible moment after 120")
        client = ModbusTcpClient("127.0.0.1", port=url.port, timeout=30)
        assert client.connect()
        assert client.read_discrete_inputs(0, count=8).bits[:8] == AT_START
        client.close()
        code, error = served.end(signal.SIGINT)
    assert code == 130
    assert error == "runglight: interrupted\n"
    assert served.lines[-2:] == ["cell: 0 cycles, 6 changes", "labels.json: 0 faults"]
    assert json.loads((tmp_path / "labels.json").read_text()) == []
    symbols = read_symbols(tmp_path / "symbols.csv")
    assert symbols is not None
    addresses = [line.split(",")[0] for line in (tmp_path / "symbols.csv").read_text().splitlines()]
    assert addresses[1:] == [symbol.address for symbol in PLANTS["cell"].symbols]


def test_s7_and_a_clean_end_by_termination(simulate: Command, tmp_path: Path) -> None:
    with simulate("--serve", "s7://127.0.0.1:0", "--symbols", "symbols.csv") as served:
        url = urlsplit(served.tap_url())
        assert url.query == "pe=0-1&pa=0-1&interval=10ms"
        client = Client()
        client.connect("127.0.0.1", 0, 2, tcp_port=url.port)
        inputs = client.read_area(Area.PE, 0, 0, 1)[0]
        assert [bool(inputs >> bit & 1) for bit in range(8)] == AT_START
        code, error = served.end(signal.SIGTERM)
        client.disconnect()
    assert (code, error) == (130, "")
    lines = (tmp_path / "symbols.csv").read_text().splitlines()
    assert lines[1].startswith("I0.0,Group1,PrtLDR,RET,")
    assert sum(line.startswith("Q") for line in lines) == 13


def test_a_fault_is_seen_by_whoever_reads(simulate: Command, tmp_path: Path) -> None:
    """Fault 7 comes 12 s after the start: the home sensor drops out."""
    with simulate(
        *["--serve", "modbus://127.0.0.1:0", "--fault", "7", "--labels", "labels.json"],
    ) as served:
        url = urlsplit(served.tap_url())
        client = ModbusTcpClient("127.0.0.1", port=url.port, timeout=30)
        assert client.connect()
        assert client.read_discrete_inputs(0, count=1).bits[0]
        deadline_s = time.monotonic() + 60
        while client.read_discrete_inputs(0, count=1).bits[0]:
            assert time.monotonic() < deadline_s
            time.sleep(0.02)
        served.read_until("fault 7 begins: The part loader's home sensor drops out")
        served.read_until("fault 7 ret-off-at-home is over")
        assert client.read_discrete_inputs(0, count=1).bits[0]
        client.close()
        assert served.end(signal.SIGINT)[0] == 130
    (label,) = json.loads((tmp_path / "labels.json").read_text())
    assert label["number"] == 7
    assert label["time_ns"] <= label["shown_ns"] < label["time_ns"] + 20_000_000
    assert label["faulty"] == ["Group1-PrtLDR-RET_ON", "Group1-PrtLDR-RET_OFF"]


def test_it_ends_by_itself_when_asked(runglight: Command) -> None:
    done = runglight("simulate", "cell", "--serve", "modbus://127.0.0.1:0", "--for", "300ms")
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "cell: 0 cycles, 6 changes"
    assert done.stderr == ""


def test_who_opens_it_to_the_network_is_told(runglight: Command) -> None:
    done = runglight("simulate", "cell", "--serve", "modbus://0.0.0.0:0", "--for", "100ms")
    assert done.returncode == 0, done.stderr
    assert "tap it with: modbus://127.0.0.1:" in done.stdout
    assert "note: whoever reaches this computer can read modbus://0.0.0.0:" in done.stderr


def test_wrong_use_ends_in_a_sentence(refused: Callable[..., str], tmp_path: Path) -> None:
    def wrong(*options: str, plant: str = "cell") -> str:
        return refused("simulate", plant, *options)

    serve = ("--serve", "modbus://127.0.0.1:0")
    assert "names no address to listen at" in wrong("--serve", "modbus://:5020")
    assert "nothing is served over 'opcua'" in wrong("--serve", "opcua://127.0.0.1:4840")
    assert "--after: says when, but not what" in wrong(*serve, "--after", "60s")
    assert "--after: 2 times for 1 fault" in wrong(
        *serve, "--fault", "3", "--after", "1s", "--after", "2s"
    )
    assert "--after: 'soon' is not a duration" in wrong(*serve, "--fault", "3", "--after", "soon")
    assert "--for: 'ever' is not a duration" in wrong(*serve, "--for", "ever")
    assert "--fault: this plant has no fault '13'" in wrong(*serve, "--fault", "13")
    assert "fault 3 open-decelerated is there already" in wrong(
        *serve, "--fault", "3", "--fault", "open-decelerated"
    )
    assert "--cycles beside --serve" in wrong(*serve, "--cycles", "3")
    assert "--log beside --serve" in wrong(*serve, "--log", "x.csv")
    assert "--after goes with --serve only" in wrong("--log", "x.csv", "--after", "3s")
    assert "--for goes with --serve only" in wrong("--log", "x.csv", "--for", "3s")
    assert "cannot be served; simulate cell can" in wrong(*serve, plant="bodyshop")
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        assert f"port {port} is taken" in wrong(
            "--serve", f"s7://127.0.0.1:{port}", "--labels", "labels.json"
        )
    assert not (tmp_path / "labels.json").exists()
