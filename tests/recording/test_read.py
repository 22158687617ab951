import shutil
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

import runglight as rl
from runglight.log.changelog import Log
from runglight.recording.read import MISSING, log_to_its_end, open_recording, read_recording
from runglight.recording.recorder import Recorder, SealAt
from runglight.recording.session import STOPPED
from runglight.taps.base import Batch, Gap, TapSignal
from tests.conftest import Command, simulated
from tests.recording.conftest import SmallDisk
from tests.recording.doubles import (
    SECOND,
    START_NS,
    Tapped,
    at,
    batch,
    eventually,
    record,
    recorder,
)


def values(directory: Path, **range_: object) -> list[int]:
    value: list[int] = read_recording(directory, **range_).columns()[2].tolist()  # type: ignore[arg-type]
    return value


@pytest.fixture
def in_pieces(tmp_path: Path) -> Path:
    """Three segments (rows 1-2, 11-12, 21-22) and a tail that was not sealed (31-32)."""
    for start in (0, 10, 20):
        record(tmp_path, [hour(start)])
    with recorder(tmp_path) as at_work:
        at_work.append(hour(30))
        eventually(lambda: at_work.until_ns == at(33))
        shutil.copytree(tmp_path, tmp_path / "copy")
    return tmp_path / "copy"


def hour(start: int) -> Batch:
    rows = [(start + 1, 0, start + 1), (start + 2, 0, start + 2)]
    return batch(start + 3, rows, [start + 1, start + 2, start + 3])


def test_a_range_of_time(in_pieces: Path) -> None:
    assert values(in_pieces) == [1, 2, 11, 12, 21, 22, 31, 32]
    assert values(in_pieces, since=at(2), until=at(21)) == [2, 11, 12, 21]
    assert values(in_pieces, since=at(31.5)) == [32]
    assert values(in_pieces, until=at(0.5)) == []
    start = datetime(1970, 1, 1, tzinfo=UTC) + timedelta(microseconds=START_NS // 1000)
    assert values(in_pieces, since=start + timedelta(seconds=22)) == [22, 31, 32]
    assert read_recording(in_pieces, at(2), at(12)).engine.gaps == [(at(3), at(11))]
    with pytest.raises(rl.InputError, match="has no time zone"):
        read_recording(in_pieces, since=datetime(2026, 1, 1))


def test_what_lies_outside_the_range_is_not_opened(in_pieces: Path) -> None:
    (in_pieces / "segments" / "000001.parquet").write_bytes(b"garbled")
    assert values(in_pieces, since=at(10)) == [11, 12, 21, 22, 31, 32]
    with pytest.raises(rl.InputError, match=r"000001\.parquet: is damaged \(its check sum"):
        read_recording(in_pieces)


def test_a_segment_moved_away_is_a_gap(in_pieces: Path) -> None:
    (in_pieces / "segments" / "000002.parquet").unlink()
    with pytest.raises(rl.InputError, match=r"000002\.parquet: is missing; .*move what is left"):
        read_recording(in_pieces)
    (in_pieces / "segments" / "000002.scans.npz").unlink()
    recording = open_recording(in_pieces)
    assert values(in_pieces) == [1, 2, 21, 22, 31, 32]
    assert recording.log.report.notes == ["segment 000002 is missing: that time is a gap"]
    assert Gap(at(3), at(13), MISSING) in recording.marks


def test_without_its_tail_the_segments_are_read(in_pieces: Path) -> None:
    for path in in_pieces.glob("tail.sqlite*"):
        path.unlink()
    log = read_recording(in_pieces)
    assert log.columns()[2].tolist() == [1, 2, 11, 12, 21, 22]
    assert log.report.notes == [
        "tail.sqlite is missing: what was not yet in a segment is not there"
    ]
    record(in_pieces, [hour(40)])
    recording = open_recording(in_pieces)
    assert recording.log.columns()[2].tolist() == [1, 2, 11, 12, 21, 22, 41, 42]
    assert recording.marks[-1] == Gap(at(23), at(41), STOPPED)


def test_reading_while_another_records(tmp_path: Path) -> None:
    with recorder(tmp_path, SealAt(rows=3)) as at_work:
        for row in range(12):
            at_work.append(batch(row + 1, [(row + 0.5, 0, row)], [row + 0.5]))
            eventually(lambda: at_work.until_ns == at(row + 1))  # noqa: B023
            assert values(tmp_path) == list(range(row + 1))


def test_reading_from_a_read_only_disk(in_pieces: Path, small_disk: SmallDisk) -> None:
    directory = small_disk.path / "recording"
    shutil.copytree(in_pieces, directory, ignore=shutil.ignore_patterns("*-shm"))
    small_disk.remount("ro")
    with pytest.raises(rl.InputError, match="copy the whole recording"):
        read_recording(directory)
    small_disk.remount("rw")
    record(directory, [hour(40)])
    small_disk.remount("ro")
    assert values(directory)[-3:] == [32, 41, 42]
    with pytest.raises(rl.InputError, match="cannot be written"):
        recorder(directory)


def test_scans_that_took_longer_than_wanted(tmp_path: Path) -> None:
    record(tmp_path, [batch(1, scans_s=[0.1, 0.25, 0.4, 0.55])])
    assert read_recording(tmp_path).scan_interval_s == pytest.approx(0.15)


def test_a_directory_that_is_no_recording(tmp_path: Path) -> None:
    with pytest.raises(rl.InputError, match="is no recording, because it has no"):
        read_recording(tmp_path)


def recorded(log: Log, directory: Path, gap: tuple[int, int] | None = None) -> None:
    """A log as a tap would have given it, with nothing seen in a gap."""
    time_ns, index, value = log.columns()
    signals = [TapSignal(name, name) for name in log.signals]
    end_ns = int(time_ns[-1])
    with Recorder(directory, Tapped(signals), reserve_bytes=0) as made:
        if gap is None:
            made.append(Batch(end_ns, time_ns, index, value))
            return
        before, after = time_ns < gap[0], time_ns > gap[1]
        made.append(Batch(gap[0], time_ns[before], index[before], value[before]))
        mark = Gap(gap[0], gap[1], "cable cut")
        made.append(Batch(end_ns, time_ns[after], index[after], value[after], marks=(mark,)))


def test_learn_watch_and_export_take_a_recording(
    runglight: Command, tmp_path: Path, cell: Path
) -> None:
    recorded(rl.read_log(cell / "nominal.csv"), tmp_path / "nominal")
    recorded(rl.read_log(cell / "faulty.csv"), tmp_path / "faulty")
    learned = runglight("learn", "nominal", "-o", "m", "--symbols", cell / "symbols.csv")
    assert learned.returncode == 0, learned.stderr
    by_recording = runglight("watch", "m", "faulty", "--format", "jsonl")
    by_file = runglight("watch", cell / "cell.model", cell / "faulty.csv", "--format", "jsonl")
    assert by_recording.stdout == by_file.stdout
    assert by_file.stdout
    assert runglight("export", "faulty", "--to", "faulty.csv").returncode == 0
    assert len(rl.read_log(tmp_path / "faulty.csv")) == len(rl.read_log(cell / "faulty.csv"))


def test_gaps_reach_watching_and_learning(tmp_path: Path, nominal_model: rl.NominalModel) -> None:
    log = simulated(seed=3)
    time_ns, _, _ = log.columns()
    gap = (int(time_ns[len(log) // 2]), int(time_ns[len(log) // 2]) + 20 * SECOND)
    recorded(log, tmp_path / "with", gap)
    seen = read_recording(tmp_path / "with")
    assert seen.engine.gaps == [gap]

    told = list(nominal_model.watch(seen))
    assert [finding["kind"] for finding in told if finding["kind"] == "gap"] == ["gap"]
    assert not [finding for finding in told if finding["severity"] == "fault"]
    unmarked = Log.from_columns(*seen.columns(), seen.signals)
    assert [each for each in nominal_model.watch(unmarked) if each["severity"] == "fault"]

    with_gap, without = rl.learn(seen), rl.learn(unmarked)
    assert len(with_gap.rules_json()) < len(without.rules_json())


def test_gaps_are_kept_in_the_order_of_what_follows_them() -> None:
    log = simulated(cycles=1)
    again = Log.from_columns(*log.columns(), log.signals, gaps=[(7, 9), (1, 3), (2, 3)])
    assert again.engine.gaps == [(1, 3), (2, 3), (7, 9)]


def test_a_gap_that_ends_before_it_starts_is_refused() -> None:
    empty = Log.from_columns(*simulated(cycles=1).columns(), simulated(cycles=1).signals)
    with pytest.raises(rl.InputError, match="a gap ends at 5, before it starts at 9"):
        Log.from_columns(*empty.columns(), empty.signals, gaps=[(9, 5)])


def test_a_line_that_stood_still_until_the_end_has_stopped(
    tmp_path: Path, nominal_model: rl.NominalModel
) -> None:
    log = simulated(seed=3)
    end_ns = int(log.columns()[0][-1])
    signals = [TapSignal(name, name) for name in log.signals]
    with Recorder(tmp_path / "recording", Tapped(signals), reserve_bytes=0) as recorder:
        recorder.append(Batch(end_ns, *log.columns()))
        recorder.append(Batch(until_ns=end_ns + 600 * SECOND))
    closed = log_to_its_end(tmp_path / "recording")
    assert int(closed.columns()[0][-1]) == end_ns + 600 * SECOND
    kinds = [finding["kind"] for finding in nominal_model.watch(closed)]
    assert "stall" in kinds
    open_end = read_recording(tmp_path / "recording")
    assert "stall" not in [finding["kind"] for finding in nominal_model.watch(open_end)]
