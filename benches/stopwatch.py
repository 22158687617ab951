"""Processor time, which other work on the machine disturbs least."""

import os
import subprocess
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

Result = TypeVar("Result")


@dataclass(slots=True)
class Stopwatch:
    """The processor seconds of several repetitions of one thing."""

    seconds: list[float] = field(default_factory=list)

    def time(self, work: Callable[[], Result]) -> Result:
        """Does the work once and remembers what it took, all threads together."""
        began = time.process_time()
        result = work()
        self.seconds.append(time.process_time() - began)
        return result

    @property
    def best(self) -> float:
        """The least of all repetitions."""
        return min(self.seconds)


def run_and_time(
    command: Sequence[str | Path], environment: Mapping[str, str] | None = None
) -> tuple[float, float]:
    """Runs a command to its end; processor and wall seconds it took.

    Raises subprocess.CalledProcessError where it fails.
    """
    began, children = time.perf_counter(), _children_s()
    subprocess.run(command, env=environment, capture_output=True, check=True)
    return _children_s() - children, time.perf_counter() - began


def _children_s() -> float:
    times = os.times()
    return times.children_user + times.children_system
