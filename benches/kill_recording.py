"""Kills a recorder at random moments and looks at what is left.

`python -m benches.kill_recording [KILLS]`: a process records 10,000 changes and 3,000 scans a
second, is killed (SIGKILL) at a random moment, and its recording is read. Five kills go to one
directory, so that what was killed is also gone on with. Segments are small, so that many kills fall
into their sealing.
"""

import random
import selectors
import signal
import struct
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from runglight.recording.read import open_recording
from runglight.recording.recorder import Recorder, SealAt
from runglight.taps.base import Batch, TapSignal

CHANGES_PER_S = 10_000
SCANS_PER_S = 3_000
BATCH_S = 0.01
SEAL_ROWS = 4_000
KILLS_PER_DIRECTORY = 5
SIGNALS = [TapSignal(f"Cell-Device{n}-Signal", f"%IX{n // 8}.{n % 8}") for n in range(400)]
_GIVEN = struct.Struct("<qq")


@dataclass
class Synthetic:
    """What a recorder knows of the synthetic tap."""

    signals: list[TapSignal] = field(default_factory=lambda: list(SIGNALS))
    url: str = "synthetic:"
    interval_ns: int | None = 0


@dataclass(frozen=True)
class Killed:
    """What was left after one kill."""

    lost_s: float
    """Time between the last change given to the recorder and the last one read."""
    rows: int
    doubled: int
    missing: int
    """Changes that are not there although later ones are."""


def synthetic_batch(start_ns: int, end_ns: int, first_row: int) -> Batch:
    """What happened in (start, end]: values count on, so that nothing can hide."""
    seconds = (end_ns - start_ns) / 1e9
    rows, scans = round(CHANGES_PER_S * seconds), round(SCANS_PER_S * seconds)
    time_ns = _spread(start_ns, end_ns, rows)
    value = np.arange(first_row, first_row + rows, dtype=np.int64)
    return Batch(
        until_ns=end_ns,
        time_ns=time_ns,
        signal_index=(value % len(SIGNALS)).astype(np.uint32),
        value=value,
        scan_ns=_spread(start_ns, end_ns, scans),
    )


def _spread(start_ns: int, end_ns: int, count: int) -> "np.ndarray[tuple[int], np.dtype[np.int64]]":
    return end_ns - (end_ns - start_ns) * np.arange(count, dtype=np.int64)[::-1] // max(count, 1)


def record(directory: Path, first_row: int) -> None:
    """Records until killed; says on standard output what the recorder was given."""
    with Recorder(directory, Synthetic(), seal_at=SealAt(SEAL_ROWS)) as recorder:
        now_ns = time.time_ns()
        while True:
            time.sleep(BATCH_S)
            start_ns, now_ns = now_ns, time.time_ns()
            batch = synthetic_batch(start_ns, now_ns, first_row)
            first_row += len(batch)
            recorder.append(batch)
            sys.stdout.buffer.write(_GIVEN.pack(now_ns, first_row))
            sys.stdout.buffer.flush()


def kill_once(directory: Path, first_row: int, after_s: float) -> Killed:
    """Starts a recorder, kills it `after_s` after its first batch, reads the recording."""
    with subprocess.Popen(
        [sys.executable, "-m", "benches.kill_recording", "--record", directory, str(first_row)],
        stdout=subprocess.PIPE,
        cwd=Path(__file__).parent.parent,
    ) as process:
        assert process.stdout is not None
        with selectors.DefaultSelector() as selector:
            selector.register(process.stdout, selectors.EVENT_READ)
            assert selector.select(timeout=60), "the recorder did not start"
        time.sleep(after_s)
        process.send_signal(signal.SIGKILL)
        said = process.stdout.read()
    said = said[: len(said) // _GIVEN.size * _GIVEN.size]
    given = [given_ns for given_ns, _ in _GIVEN.iter_unpack(said)]
    recording = open_recording(directory)
    _, _, value = recording.log.columns()
    distinct = np.unique(value)
    missing = int(value.max()) + 1 - len(distinct) if len(value) else 0
    return Killed(
        # Where nothing was committed yet, all since the first batch is lost.
        lost_s=(given[-1] - max(recording.until_ns, given[0] - round(BATCH_S * 1e9))) / 1e9,
        rows=len(value),
        doubled=len(value) - len(distinct),
        missing=missing,
    )


def kills(count: int, directory: Path, seed: int, longest_s: float = 2.5) -> list[Killed]:
    """Kills `count` recorders in turn."""
    chance = random.Random(seed)
    results: list[Killed] = []
    rows = 0
    for number in range(count):
        if number % KILLS_PER_DIRECTORY == 0:
            rows = 0
        place = directory / f"recording{number // KILLS_PER_DIRECTORY}"
        results.append(kill_once(place, rows, chance.uniform(0.0, longest_s)))
        rows = results[-1].rows
    return results


def main(arguments: list[str]) -> None:
    """Prints what 50 kills (or as many as said) did."""
    if arguments[:1] == ["--record"]:
        record(Path(arguments[1]), int(arguments[2]))
        return
    count = int(arguments[0]) if arguments else 50
    with tempfile.TemporaryDirectory() as directory:
        results = kills(count, Path(directory), seed=1)
    lost = [killed.lost_s for killed in results]
    print(
        f"{count} kills: {len(results)} recordings opened; lost at most {max(lost):.3f} s, "
        f"{sorted(lost)[len(lost) // 2]:.3f} s in the median; "
        f"{sum(killed.doubled for killed in results)} changes doubled, "
        f"{sum(killed.missing for killed in results)} missing before the last one"
    )


if __name__ == "__main__":
    main(sys.argv[1:])
