"""How fast the polled taps scan: `python -m benches.scanning [modbus] [s7] [--minutes M]`.

400 Modbus variables and 27 S7 input bytes on loopback, the server in a process of its own, as fast
as it goes unless `--interval` says otherwise. Prints scans per second and the intervals between
scans, as percentiles and as a histogram. `--record` writes a recording meanwhile, to a temporary
directory, and says at the end what it holds.
"""

import argparse
import asyncio
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt
from rich.console import Console
from rich.table import Table

from benches.scanning_server import MODBUS_VARIABLES, S7_BYTES
from runglight.recording.read import open_recording
from runglight.recording.recorder import Recorder
from runglight.taps import open_tap
from runglight.taps.base import Batch, Gap, Tap

Take = Callable[[Tap, Batch], None]
"""What is done with each batch: a recording is made by giving one that writes."""

FLOORS = {"modbus": 400, "s7": 3_000}
"""Scans per second that must be reached."""
EDGES_MS = (0, 0.1, 0.2, 0.3, 0.5, 1, 2, 3, 5, 10, 20, 50, 100, 1_000, np.inf)
BAR = 50


@dataclass(slots=True)
class Scans:
    """What was seen of one tap."""

    took_s: float = 0.0
    changes: int = 0
    gaps: int = 0
    scan_ns: list[npt.NDArray[np.int64]] = field(default_factory=list)

    def add(self, batch: Batch) -> None:
        """One batch more."""
        self.scan_ns.append(batch.scan_ns)
        self.changes += 0 if batch.image else len(batch)
        self.gaps += sum(isinstance(mark, Gap) for mark in batch.marks)

    @property
    def intervals_ms(self) -> npt.NDArray[np.float64]:
        """From each scan to the next."""
        return np.diff(np.concatenate(self.scan_ns)).astype(np.float64) / 1e6

    @property
    def per_second(self) -> float:
        """Mean rate."""
        return 1_000 / float(self.intervals_ms.mean())


def url_of(protocol: str, port: int) -> str:
    """What is scanned."""
    if protocol == "modbus":
        half = MODBUS_VARIABLES // 2
        return f"modbus://127.0.0.1:{port}?coils={half}-{MODBUS_VARIABLES - 1}&inputs=0-{half - 1}"
    return f"s7://127.0.0.1:{port}?pe=0-{S7_BYTES - 1}"


def nothing(tap: Tap, batch: Batch) -> None:
    """Scanning alone."""


def measure(protocol: str, seconds: float, interval: str = "0", take: Take = nothing) -> Scans:
    """Scans a server of the protocol for so long."""
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        port: int = found.getsockname()[1]
    command = [sys.executable, "-m", "benches.scanning_server", protocol, str(port)]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, encoding="utf-8"
    ) as server:
        assert server.stdin is not None
        assert server.stdout is not None
        # The server ends with its standard input.
        with server.stdin:
            assert server.stdout.readline() == "ready\n"
            return asyncio.run(_scan(url_of(protocol, port), seconds, interval, take))


async def _scan(url: str, seconds: float, interval: str, take: Take) -> Scans:
    scans = Scans()
    async with open_tap(url, interval=interval) as tap:
        began = time.monotonic()
        async for batch in tap:
            scans.add(batch)
            take(tap, batch)
            scans.took_s = time.monotonic() - began
            if scans.took_s >= seconds:
                break
    return scans


class Recording:
    """Writes every batch to a recording."""

    def __init__(self, directory: Path) -> None:
        self._directory = directory
        self._recorder: Recorder | None = None

    def __call__(self, tap: Tap, batch: Batch) -> None:
        """Takes a batch."""
        if self._recorder is None:
            self._recorder = Recorder(self._directory, tap)
        self._recorder.append(batch)

    def close(self) -> str:
        """Ends it, reads it back, and says what it holds."""
        assert self._recorder is not None
        self._recorder.close()
        recording = open_recording(self._directory)
        size = sum(file.stat().st_size for file in self._directory.rglob("*") if file.is_file())
        return (
            f"recorded: {len(recording.scan_ns):,} scans, {len(recording.log):,} rows, "
            f"{len(recording.log.gaps)} gaps, {size / 1e6:.1f} MB"
        )


def histogram(scans: Scans) -> Table:
    """How often which interval was met."""
    counts, _ = np.histogram(scans.intervals_ms, EDGES_MS)
    table = Table("interval, ms", "scans", "")
    for low, high, count in zip(EDGES_MS, EDGES_MS[1:], counts.tolist(), strict=False):
        if count:
            bar = "█" * max(round(BAR * count / counts.sum()), 1)
            table.add_row(f"{low:g} - {high:g}", f"{count:,}", bar)
    return table


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("protocol", nargs="*", default=list(FLOORS), help="modbus, s7")
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--interval", default="0", help="10ms; 0 for as fast as it goes")
    parser.add_argument("--record", action="store_true", help="write a recording meanwhile")
    asked = parser.parse_args()
    console = Console()
    for protocol in asked.protocol:
        with tempfile.TemporaryDirectory() as directory:
            recording = Recording(Path(directory) / "recording")
            take = recording if asked.record else nothing
            scans = measure(protocol, asked.minutes * 60, asked.interval, take)
            recorded = recording.close() if asked.record else "not recorded"
        p50, p99, p999 = np.percentile(scans.intervals_ms, [50, 99, 99.9])
        console.print(
            f"{protocol}: {scans.per_second:,.0f} scans/s (floor {FLOORS[protocol]:,}) "
            f"for {scans.took_s:.0f} s; interval p50 {p50:.3f} ms, p99 {p99:.3f} ms, "
            f"p99.9 {p999:.3f} ms, max {scans.intervals_ms.max():.1f} ms; "
            f"{scans.changes:,} changes, {scans.gaps} gaps; {recorded}"
        )
        console.print(histogram(scans))


if __name__ == "__main__":
    main()
