"""What recording costs: processor seconds per second at 10,000 changes and 3,000 scans a second.

`python -m benches.recording_cost [SECONDS]` drives a recorder at that pace, once with a batch every
10 ms and once with a batch per scan, and takes off what making the batches costs by itself.
"""

import sys
import tempfile
import time
from pathlib import Path

from benches.kill_recording import CHANGES_PER_S, SCANS_PER_S, Synthetic, synthetic_batch
from runglight.recording.recorder import Recorder, SealAt

TURN_S = 0.01


def spent_s(directory: Path | None, seconds: float, batches_per_turn: int) -> float:
    """Processor seconds of the whole process; without a directory nothing is recorded."""
    recorder = None
    if directory is not None:
        # Sealed often enough that its cost is in the measurement.
        seal_at = SealAt(rows=round(CHANGES_PER_S * seconds / 3))
        recorder = Recorder(directory, Synthetic(), seal_at=seal_at)
    before_s, until = time.process_time(), time.monotonic() + seconds
    now_ns, row = time.time_ns(), 0
    while time.monotonic() < until:
        time.sleep(TURN_S)
        turn_ns = (time.time_ns() - now_ns) // batches_per_turn
        for _ in range(batches_per_turn):
            batch = synthetic_batch(now_ns, now_ns + turn_ns, row)
            now_ns += turn_ns
            row += len(batch)
            if recorder is not None:
                recorder.append(batch)
    if recorder is not None:
        recorder.close()
    return time.process_time() - before_s


def main(arguments: list[str]) -> None:
    """Prints the cost."""
    seconds = float(arguments[0]) if arguments else 30.0
    scans_per_turn = round(SCANS_PER_S * TURN_S)
    for batches_per_turn, what in (
        (1, "a batch every 10 ms"),
        (scans_per_turn, "a batch per scan"),
    ):
        with tempfile.TemporaryDirectory() as place:
            recording = Path(place) / "recording"
            idle_s = spent_s(None, seconds, batches_per_turn)
            busy_s = spent_s(recording, seconds, batches_per_turn)
            written = sum(path.stat().st_size for path in recording.rglob("*.[pn]*"))
        print(
            f"{CHANGES_PER_S:,} changes/s and {SCANS_PER_S:,} scans/s, {what}: "
            f"{100 * (busy_s - idle_s) / seconds:.1f} % of a core "
            f"(making the batches: {100 * idle_s / seconds:.1f} %), "
            f"{written / seconds / 1000:.0f} kB/s sealed"
        )


if __name__ == "__main__":
    main(sys.argv[1:])
