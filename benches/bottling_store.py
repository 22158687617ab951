"""Recordings of the bottling machine kept as arrays: recorded once, evaluated as often as needed.

A seed that is there is not recorded again, so that several processes may share the work
(`--part 1/2`) and one that was stopped goes on.
"""

import asyncio
import os
import tempfile
from pathlib import Path

import numpy as np

from benches.bottling_cases import SCAN_NS, Case, Recorded, recorded
from runglight.log.changelog import Log
from runglight.plants.bottling import Happening, Sight


def kept(folder: Path, case: Case, seed: int, minutes: float) -> Recorded:
    """The recording of a seed, recorded now where it is not there."""
    path = folder / f"{case.name}-{minutes:g}min-{seed:03d}.npz"
    if not path.exists():
        with tempfile.TemporaryDirectory() as directory:
            fresh = asyncio.run(recorded(case, seed, Path(directory) / "recording", minutes))
        _keep(path, fresh)
    return _read(path)


def until(recording: Recorded, minutes: float) -> Recorded:
    """The beginning of a recording."""
    end_ns = int(recording.scan_ns[0]) + round(60e9 * minutes)
    time_ns, signal, value = recording.log.columns()
    within = time_ns <= end_ns
    return Recorded(
        _log(time_ns[within], signal[within], value[within], recording.log.signals),
        recording.scan_ns[recording.scan_ns <= end_ns],
        tuple(sight for sight in recording.sights if sight.time_ns <= end_ns),
    )


def _keep(path: Path, recording: Recorded) -> None:
    time_ns, signal, value = recording.log.columns()
    path.parent.mkdir(parents=True, exist_ok=True)
    growing = path.with_suffix(f".{os.getpid()}.npz")
    np.savez_compressed(
        growing,
        time_ns=time_ns,
        signal=signal,
        value=value,
        signals=np.array(recording.log.signals),
        scan_ns=recording.scan_ns,
        sight_ns=np.array([sight.time_ns for sight in recording.sights], np.int64),
        sights=np.array([sight.what.name for sight in recording.sights]),
    )
    growing.replace(path)


def _read(path: Path) -> Recorded:
    with np.load(path) as file:
        sights = zip(file["sight_ns"].tolist(), file["sights"].tolist(), strict=True)
        return Recorded(
            _log(file["time_ns"], file["signal"], file["value"], file["signals"].tolist()),
            file["scan_ns"],
            tuple(Sight(time_ns, Happening[what]) for time_ns, what in sights),
        )


def _log(time_ns: np.ndarray, signal: np.ndarray, value: np.ndarray, signals: list[str]) -> Log:
    return Log.from_columns(
        time_ns, signal.astype(np.uint32), value, signals, scan_interval_s=SCAN_NS / 1e9
    )
