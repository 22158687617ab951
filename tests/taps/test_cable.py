"""A cable that is cut, between two network namespaces: one with the PLC, one with the tap.

Both ends are in namespaces of their own, so that nothing of the computer's own network is touched.
Needs root and `ip netns`, and is skipped where there is neither.
"""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.taps.benches.modbus import ModbusBench
from tests.taps.benches.s7 import S7Bench

ROOT = Path(__file__).parents[2]
OURS, PLC = "10.0.0.1", "10.0.0.2"
PORT = 5_020
BENCHES = {"modbus": ModbusBench, "s7": S7Bench}


class Cable:
    """Two ends of one cable, `near` with the tap and `far` with the PLC."""

    def __init__(self) -> None:
        self.near, self.far = (f"runglight-{os.getpid()}-{end}" for end in ("tap", "plc"))

    def lay(self) -> None:
        for namespace in (self.near, self.far):
            run("ip", "netns", "add", namespace)
        # Made inside the namespaces: it never is an interface of the computer.
        run(
            "ip", "-n", self.near, "link", "add", "cable", "type", "veth",
            "peer", "name", "cable", "netns", self.far,
        )  # fmt: skip
        for namespace, address in ((self.near, OURS), (self.far, PLC)):
            run("ip", "-n", namespace, "address", "add", f"{address}/30", "dev", "cable")
            run("ip", "-n", namespace, "link", "set", "cable", "up")

    def take_away(self) -> None:
        for namespace in (self.near, self.far):
            subprocess.run(["ip", "netns", "del", namespace], check=False, capture_output=True)

    def pull(self) -> None:
        """The plug at our end is pulled."""
        run("ip", "-n", self.near, "link", "set", "cable", "down")

    def plug(self) -> None:
        run("ip", "-n", self.near, "link", "set", "cable", "up")

    def drop(self) -> None:
        """Something on the way drops everything, and says nothing."""
        run(*inside(self.far, "nft", "add", "table", "inet", "cut"))
        chain = "{ type filter hook input priority 0; policy drop; }"
        run(*inside(self.far, "nft", "add", "chain", "inet", "cut", "arriving", chain))

    def pass_again(self) -> None:
        run(*inside(self.far, "nft", "delete", "table", "inet", "cut"))


def inside(namespace: str, *command: str) -> tuple[str, ...]:
    return ("ip", "netns", "exec", namespace, *command)


def run(*command: str) -> None:
    subprocess.run(command, check=True, capture_output=True)


def process(namespace: str, module: str, *arguments: str) -> "subprocess.Popen[str]":
    """A module of ours in a namespace; it ends when its standard input does."""
    return subprocess.Popen(
        inside(namespace, sys.executable, "-m", module, *arguments),
        cwd=ROOT,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        encoding="utf-8",
    )


@pytest.fixture
def cable() -> Iterator[Cable]:
    if os.geteuid() != 0 or not shutil.which("ip"):
        pytest.skip("laying a cable needs root and ip netns")
    laid = Cable()
    try:
        try:
            laid.lay()
        except subprocess.CalledProcessError as error:
            pytest.skip(f"no network namespaces here: {error.stderr}")
        yield laid
    finally:
        laid.take_away()


@pytest.fixture(params=list(BENCHES))
def tapped(request: pytest.FixtureRequest, cable: Cable) -> Iterator[Callable[[], dict[str, Any]]]:
    """Tells what a tap at the near end sees of the PLC at the far end, one thing at a time."""
    protocol: str = request.param
    url = BENCHES[protocol](host=PLC, port=PORT).url
    with process(cable.far, "tests.taps.benches.serve", protocol, PLC, str(PORT)) as server:
        assert server.stdout is not None
        assert server.stdin is not None
        assert server.stdout.readline() == "ready\n"
        with process(cable.near, "tests.taps.benches.watch", url) as watching:
            assert watching.stdout is not None
            assert watching.stdin is not None
            lines = watching.stdout

            def told() -> dict[str, Any]:
                line: dict[str, Any] = json.loads(lines.readline())
                return line

            yield told
            watching.stdin.close()
        server.stdin.close()


Cut = tuple[Callable[[Cable], None], Callable[[Cable], None]]
CUTS: dict[str, Cut] = {
    "unplugged": (Cable.pull, Cable.plug),
    "dropped": (Cable.drop, Cable.pass_again),
}


@pytest.mark.parametrize("cut", CUTS)
def test_a_cut_cable_is_a_gap_and_then_a_whole_image(
    cable: Cable, tapped: Callable[[], dict[str, Any]], cut: str
) -> None:
    sever, mend = CUTS[cut]
    first = tapped()
    assert first["image"]
    assert not first["gaps"]
    assert not any(first["values"])
    try:
        sever(cable)
    except (subprocess.CalledProcessError, FileNotFoundError) as error:
        pytest.skip(f"traffic cannot be dropped here: {error}")
    retrying = tapped()
    assert retrying == {"state": "retrying"}
    mend(cable)
    back = tapped()
    assert back["image"]
    assert back["values"] == first["values"]
    ((start_ns, end_ns),) = back["gaps"]
    assert start_ns < end_ns == back["time_ns"]
    # At least the time-out of one reply, less the scan before.
    assert end_ns - start_ns >= 400_000_000
    assert back["reconnects"] == 1
