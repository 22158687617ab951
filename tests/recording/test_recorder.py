import json
import os
import subprocess
import sys
import tempfile
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from runglight.errors import InputError
from runglight.recording.read import open_recording, read_recording
from runglight.recording.recorder import Recorder, SealAt
from runglight.recording.session import CUT_OFF, STOPPED
from runglight.recording.tail import read_tail
from runglight.taps.base import Batch, ClockStep, Gap, TapSignal
from runglight.taps.named import NamedTap
from tests.recording.doubles import (
    SIGNALS,
    DoubleTap,
    Tapped,
    at,
    batch,
    batches,
    eventually,
    later,
    record,
    recorder,
    rows_of,
)


def rows_read(directory: Path) -> list[tuple[int, str, int]]:
    log = read_recording(directory)
    time_ns, index, value = log.columns()
    names = [log.signals[i] for i in index]
    return list(zip(time_ns.tolist(), names, value.tolist(), strict=True))


@settings(deadline=None, max_examples=40)
@given(batches(), st.lists(st.integers(0, 8), max_size=3), st.sampled_from([1, 5, 10**6]))
def test_any_batches_in_any_sessions_come_back(
    given: list[Batch], cuts: list[int], seal_rows: int
) -> None:
    edges = sorted({0, len(given), *(min(cut, len(given)) for cut in cuts)})
    with tempfile.TemporaryDirectory() as place:
        directory = Path(place) / "recording"
        record(directory, [])
        taken: list[Batch] = []
        for number, (start, end) in enumerate(pairwise(edges)):
            # A session begins after the one before ended, if only by a nanosecond.
            session = [later(each, number) for each in given[start:end]]
            record(directory, session, SealAt(rows=seal_rows))
            taken += session
        recording = open_recording(directory)
        assert rows_read(directory) == rows_of(taken)
    assert recording.scan_ns.tolist() == [int(t) for each in taken for t in each.scan_ns]
    told = [mark for each in taken for mark in each.marks]
    joints = [mark for mark in recording.marks if mark not in told]
    assert [mark for mark in recording.marks if mark in told] == told
    assert len(joints) == max(len(edges) - 2, 0)
    assert recording.until_ns == (taken[-1].until_ns if taken else 0)


def test_a_recording_is_gone_on_with_after_a_gap(tmp_path: Path) -> None:
    record(tmp_path, [batch(1, [(0.5, 0, 1)], [0.5, 1.0])])
    record(tmp_path, [batch(11, [(10.5, 0, 0)], [10.5, 11.0])])
    recording = open_recording(tmp_path)
    assert recording.marks == (Gap(at(1), at(10.5), STOPPED),)
    assert recording.log.engine.gaps == [(at(1), at(10.5))]
    assert recording.scan_ns.tolist() == [at(0.5), at(1), at(10.5), at(11)]
    assert rows_read(tmp_path) == [(at(0.5), "A-B-ON", 1), (at(10.5), "A-B-ON", 0)]


@pytest.mark.parametrize("step_s", [-3600, 3600])
def test_a_clock_set_between_two_sessions(tmp_path: Path, step_s: int) -> None:
    record(tmp_path, [batch(1, [(0.5, 0, 1)])])
    record(tmp_path, [batch(step_s + 3, [(step_s + 2, 0, 0), (step_s + 2.5, 0, 1)])])
    recording = open_recording(tmp_path)
    time_ns, _, _ = recording.log.columns()
    assert np.all(np.diff(time_ns) > 0)
    assert time_ns[2] - time_ns[1] == 500_000_000
    if step_s > 0:
        assert recording.marks == (Gap(at(1), at(step_s + 2), STOPPED),)
    else:
        gap, step = recording.marks
        assert gap == Gap(at(1), at(1) + 1, STOPPED)
        assert isinstance(step, ClockStep)
        assert step.step_ns == at(step_s + 2) - at(1) - 1


@pytest.mark.parametrize("step_s", [-3600, 3600])
def test_a_clock_set_while_recording_is_marked(tmp_path: Path, step_s: int) -> None:
    step = ClockStep(at(1.5), step_s * 10**9)
    record(tmp_path, [batch(1, [(0.5, 0, 1)]), batch(2, [(1.7, 0, 0)], marks=[step])])
    recording = open_recording(tmp_path)
    assert recording.marks == (step,)
    assert rows_read(tmp_path) == [(at(0.5), "A-B-ON", 1), (at(1.7), "A-B-ON", 0)]
    assert recording.log.gaps == []


def test_a_tap_that_goes_back_in_time_is_a_defect(tmp_path: Path) -> None:
    with recorder(tmp_path) as open_recorder:
        open_recorder.append(batch(2, [(1, 0, 1)]))
        for wrong in (
            batch(1),
            batch(3, [(1, 0, 1)]),
            batch(3, [(4, 0, 1)]),
            batch(3, [(2.5, 0, 1), (2.2, 0, 1)]),
        ):
            with pytest.raises(ValueError, match="a tap"):
                open_recorder.append(wrong)
    assert len(read_recording(tmp_path)) == 1


def test_signals_may_grow_while_recording(tmp_path: Path) -> None:
    signals = SIGNALS[:1]
    with Recorder(tmp_path, Tapped(signals), reserve_bytes=0) as growing:
        growing.append(batch(1, [(0.5, 0, 1)]))
        signals.extend(SIGNALS[1:])
        growing.append(batch(2, [(1.5, 2, 40)]))
    assert rows_read(tmp_path) == [(at(0.5), "A-B-ON", 1), (at(1.5), "A-C-STEP", 40)]
    written = json.loads((tmp_path / "recording.json").read_text(encoding="utf-8"))
    assert written["signals"][2] == {
        "name": "A-C-STEP",
        "address": "%MW3",
        "type": "INT",
        "class": "memory",
        "description": "step of the sequence",
    }


def test_another_order_of_the_signals_next_time(tmp_path: Path) -> None:
    record(tmp_path, [batch(1, [(0.5, 3, 7)])])
    with Recorder(tmp_path, Tapped(SIGNALS[::-1], "other:"), reserve_bytes=0) as turned:
        turned.append(batch(3, [(2.5, 3, 1), (2.6, 0, 8)]))
    assert rows_read(tmp_path) == [
        (at(0.5), "Zähler Ω", 7),
        (at(2.5), "A-B-ON", 1),
        (at(2.6), "Zähler Ω", 8),
    ]


def test_names_from_a_symbol_table_come_as_the_tap_grows(tmp_path: Path) -> None:
    tap = DoubleTap([])
    tap.signals = SIGNALS[:1]
    named = NamedTap(tap, {"%IX0.0": "Line-Clamp-CLOSED", "%QX0.0": "Line-Clamp-CLOSE"})
    with Recorder(tmp_path, named, reserve_bytes=0) as renaming:
        renaming.append(batch(1, [(0.5, 0, 1)]))
        tap.signals.append(SIGNALS[1])
        renaming.append(batch(2, [(1.5, 1, 1)]))
    assert rows_read(tmp_path) == [
        (at(0.5), "Line-Clamp-CLOSED", 1),
        (at(1.5), "Line-Clamp-CLOSE", 1),
    ]


def test_two_signals_of_one_name_are_refused(tmp_path: Path) -> None:
    twice = [TapSignal("X", "%IX0.0"), TapSignal("X", "%IX0.1")]
    with pytest.raises(InputError, match="two signals of one name: X"):
        Recorder(tmp_path, Tapped(twice), reserve_bytes=0)


def test_one_name_goes_on_to_mean_one_address(tmp_path: Path) -> None:
    record(tmp_path, [batch(1)])
    moved = [TapSignal("A-B-ON", "%IX9.9")]
    with pytest.raises(InputError, match=r"recorded from %IX0\.0 so far, and now .* %IX9\.9"):
        Recorder(tmp_path, Tapped(moved), reserve_bytes=0)
    record(tmp_path, [batch(3)])  # Refusing has left no lock behind.


def test_two_recorders_at_once_are_refused(tmp_path: Path) -> None:
    with recorder(tmp_path) as first:
        with pytest.raises(
            InputError, match=rf"another recorder \(process {os.getpid()}\) is writing here"
        ):
            recorder(tmp_path)
        first.append(batch(1, [(0.5, 0, 1)]))
    assert len(read_recording(tmp_path)) == 1
    record(tmp_path, [batch(2)])


def test_the_lock_of_a_killed_process_does_not_block(tmp_path: Path) -> None:
    program = (
        "import os, signal, sys; from pathlib import Path\n"
        "from tests.recording.doubles import batch, eventually, recorder\n"
        "r = recorder(Path(sys.argv[1])); r.append(batch(1, [(0.5, 0, 1)]))\n"
        "eventually(lambda: r.until_ns > 0); os.kill(os.getpid(), signal.SIGKILL)"
    )
    root = Path(__file__).parents[2]
    ended = subprocess.run(
        [sys.executable, "-c", program, tmp_path], cwd=root, check=False, timeout=120
    )
    assert ended.returncode == -9
    record(tmp_path, [batch(3, [(2.5, 0, 0)])])
    assert open_recording(tmp_path).marks == (Gap(at(1), at(2.5), CUT_OFF),)
    assert len(read_recording(tmp_path)) == 2


def test_a_directory_of_something_else_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").write_text("years of work")
    with pytest.raises(InputError, match="is not empty and no recording"):
        recorder(tmp_path)
    with pytest.raises(InputError, match="is a file"):
        recorder(tmp_path / "thesis.txt")
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.txt"]


def test_a_quiet_machine_is_recorded_too(tmp_path: Path) -> None:
    with recorder(tmp_path) as quiet:
        quiet.append(batch(1))
        eventually(lambda: quiet.until_ns == at(1))
        quiet.append(batch(2))
    assert open_recording(tmp_path).until_ns == at(2)
    state, blocks = read_tail(tmp_path)
    assert (state.until_ns, blocks) == (at(2), [])


def test_after_closing_nothing_is_taken(tmp_path: Path) -> None:
    closed = recorder(tmp_path)
    closed.close()
    closed.close()
    with pytest.raises(ValueError, match="closed"):
        closed.append(batch(1))
