"""kill -9 of what a test started: an executor, or a whole driver."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pyspark.sql import SparkSession

ROOT = Path(__file__).parents[2]
PATIENCE_S = 300


def executors(session: SparkSession) -> list[int]:
    """Processes of the session's executors."""
    driver = session.sparkContext._gateway.proc.pid
    return [child for child in children(driver) if b"CoarseGrainedExecutor" in command(child)]


def children(parent: int) -> list[int]:
    """Processes that a process started."""
    found = []
    for entry in Path("/proc").iterdir():
        if not entry.name.isdecimal():
            continue
        try:
            status = (entry / "stat").read_text(encoding="utf-8", errors="replace")
        except OSError:
            continue
        if int(status.rpartition(")")[2].split()[1]) == parent:
            found.append(int(entry.name))
    return sorted(found)


def command(process: int) -> bytes:
    """Command line of a process; empty where it has ended."""
    try:
        return Path(f"/proc/{process}/cmdline").read_bytes()
    except OSError:
        return b""


def kill(process: int) -> None:
    """At once, without a chance to tidy up."""
    with suppress(ProcessLookupError):
        os.kill(process, signal.SIGKILL)


def wait_until(come: Callable[[], bool], what: str) -> None:
    """Waits; the time is a guard against hanging alone."""
    deadline = time.monotonic() + PATIENCE_S
    while not come():
        assert time.monotonic() < deadline, f"{what} did not come"
        time.sleep(0.05)


def committed(checkpoint: Path) -> int:
    """Micro-batches that are done for good."""
    commits = checkpoint / "commits"
    return sum(entry.name.isdecimal() for entry in commits.iterdir()) if commits.is_dir() else 0


class Driver:
    """A driver program of its own (`driver_program`), with its executors."""

    def __init__(self, directory: Path, master: str, *arguments: str) -> None:
        self._log = (directory / "driver.log").open("ab")
        self._process = subprocess.Popen(
            [
                *(sys.executable, "-m", "tests.scale.driver_program"),
                *(str(directory), master, *arguments),
            ],
            cwd=ROOT,
            env=os.environ | {"PYTHONPATH": f"{ROOT / 'python'}:{ROOT}"},
            stdin=subprocess.DEVNULL,
            stdout=self._log,
            stderr=self._log,
        )

    @property
    def running(self) -> bool:
        return self._process.poll() is None

    def kill(self) -> None:
        """The program, its Java machine and its executors: as if their computer were gone."""
        everything = [self._process.pid]
        for process in everything:
            everything += children(process)
        for process in everything:
            kill(process)
        self._process.wait(30)
        self._log.close()

    def end(self) -> int:
        """Waits for its end."""
        try:
            return self._process.wait(PATIENCE_S)
        finally:
            if self.running:
                self.kill()
            self._log.close()
