"""A conveyor that starts and stops, and what else a machine moves, made by hand."""

from pathlib import Path

import numpy as np

from runglight.log.changelog import Log
from runglight.recording.recorder import Recorder
from runglight.taps.base import Batch, TapSignal
from tests.recording.doubles import Tapped

EPOCH = 1_704_153_600_000_000_000
"""2024-01-02."""
EVENTS = [EPOCH + second * 1_000_000_000 for second in (20, 50, 80, 110, 140, 170)]
"""When the conveyor starts and stops."""


def conveyor_log() -> Log:
    """`%MW74.0` is the conveyor, `%M25` its copy; `%MW74.7` and a counter do other things."""
    rows = [(0, "%MW74", 0), (0, "%M25", 0), (0, "%MW33", 100), (0, "%M3", 1)]
    word, running = 0, 0
    for second in range(1, 190):
        if EPOCH + second * 1_000_000_000 in EVENTS:
            running = 1 - running
            rows.append((second, "%M25", running))
        now = running | (0x80 if 35 <= second < 95 else 0)
        if now != word:
            word = now
            rows.append((second, "%MW74", word))
        if second % 9 == 0:
            rows.append((second, "%MW33", 100 + second // 9))
    rows.append((190, "%M3", 1))
    names = ["%M3", "%M25", "%MW33", "%MW74"]
    return Log.from_columns(
        np.array([EPOCH + second * 1_000_000_000 for second, _, _ in rows], np.int64),
        np.array([names.index(name) for _, name, _ in rows], np.uint32),
        np.array([value for _, _, value in rows], np.int64),
        names,
    )


def recorded(directory: Path, signals: list[TapSignal], toggles: list[int]) -> Path:
    """A recording in which every signal goes from 0 to 1 and back at the given times."""
    everything = np.arange(len(signals), dtype=np.uint32)

    def batch(time_ns: int, value: int, *, image: bool = False) -> Batch:
        return Batch(
            until_ns=time_ns,
            time_ns=np.full(len(signals), time_ns),
            signal_index=everything,
            value=np.full(len(signals), value),
            scan_ns=np.array([time_ns]),
            image=image,
        )

    with Recorder(directory, Tapped(signals=signals)) as recorder:
        recorder.append(batch(EPOCH, 0, image=True))
        for at, time_ns in enumerate(toggles):
            recorder.append(batch(time_ns, (at + 1) % 2))
        recorder.append(Batch(until_ns=toggles[-1] + 20_000_000_000))
    return directory
