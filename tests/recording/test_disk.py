import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import runglight as rl
from runglight.recording.read import read_recording
from runglight.recording.recorder import Recorder
from runglight.taps.base import Batch
from tests.recording.conftest import SmallDisk
from tests.recording.doubles import START_NS, batch, eventually, recorder


def until_it_stops(open_recorder: Recorder) -> int:
    """Appends noise, a commit at a time, until recording stops; returns the rows committed."""
    chance = np.random.default_rng(1)
    committed = 0
    for number in range(1, 2000):
        until_ns = START_NS + number * 1_000_000
        rows = 20_000
        noise = Batch(
            until_ns,
            np.full(rows, until_ns),
            chance.integers(0, 4, rows).astype(np.uint32),
            chance.integers(-(2**62), 2**62, rows),
        )
        open_recorder.append(noise)

        def done(until_ns: int = until_ns) -> bool:
            open_recorder.check()
            return open_recorder.until_ns == until_ns

        eventually(done)
        committed += rows
    raise AssertionError("the disk never was full")


def rows_kept(directory: Path) -> int:
    value = read_recording(directory).columns()[2]
    assert len(value) % 20_000 == 0
    return len(value)


def test_a_full_disk_stops_recording_and_keeps_what_was_there(small_disk: SmallDisk) -> None:
    directory = small_disk.path / "recording"
    full = recorder(directory)
    with pytest.raises(rl.InputError, match=r"recording stopped, because its disk is full; .*kept"):
        until_it_stops(full)
    full.close()
    kept = rows_kept(directory)
    assert kept >= 20_000
    assert f"{read_recording(directory).end:%H:%M:%S}" == "00:00:00"
    filler = [path for path in small_disk.path.iterdir() if path != directory]
    assert not filler
    with pytest.raises(rl.InputError):
        until_it_stops(recorder(directory))
    small_disk.remount("size=32m")
    with recorder(directory) as again:
        again.append(batch(3600, [(3599, 0, 1)]))
    assert len(read_recording(directory)) == kept + 1


def test_the_reserve_is_left_free(small_disk: SmallDisk) -> None:
    directory = small_disk.path / "recording"
    with pytest.raises(rl.InputError, match="only 4 MB are free on its disk and 100 MB are kept"):
        recorder(directory, reserve_bytes=100_000_000)
    with (
        pytest.raises(rl.InputError, match="recording stopped, because only 2 MB are free"),
        recorder(directory, reserve_bytes=2_000_000) as reserving,
    ):
        until_it_stops(reserving)
    assert rows_kept(directory) >= 20_000


def test_a_failing_disk_is_told_once(tmp_path: Path) -> None:
    """The file size limit of the operating system stands for any other refusal."""
    program = (
        "import resource, sys; from pathlib import Path\n"
        "from tests.recording.doubles import recorder\n"
        "from tests.recording.test_disk import until_it_stops\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (1_500_000, 1_500_000))\n"
        "r = recorder(Path(sys.argv[1]))\n"
        "try: until_it_stops(r)\n"
        "except Exception as error: print(f'{type(error).__name__}: {error}')\n"
        "r.close()"
    )
    ended = subprocess.run(
        [sys.executable, "-c", program, tmp_path],
        cwd=Path(__file__).parents[2],
        capture_output=True,
        encoding="utf-8",
        timeout=600,
        check=False,
    )
    assert ended.returncode == 0, ended.stderr
    assert ended.stdout.startswith(f"InputError: {tmp_path}: recording stopped, because its disk")
    assert ended.stdout.count("\n") == 1
    assert len(read_recording(tmp_path)) % 20_000 == 0
