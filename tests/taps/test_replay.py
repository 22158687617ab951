"""A replayed log is the log, whatever the speed and wherever it is cut."""

import asyncio
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from runglight.errors import InputError
from runglight.log.changelog import Log, read_log
from runglight.taps import open_tap, replay_cuts
from runglight.taps.base import QUIET_NS, Batch, Gap, Tap
from runglight.taps.replay_cuts import ReplayCuts
from tests.conftest import simulated
from tests.taps.fakes import START_NS, FakeClock

MS = 1_000_000


def replayed(source: str, clock: FakeClock | None = None) -> tuple[Tap, list[Batch], list[int]]:
    """The tap, its batches, and the clock's time at which each came."""
    clock = clock or FakeClock()

    async def read() -> tuple[Tap, list[Batch], list[int]]:
        batches: list[Batch] = []
        came: list[int] = []
        async with open_tap(source, clock=clock) as tap:
            async for batch in tap:
                batches.append(batch)
                came.append(clock.now_ns())
        return tap, batches, came

    return asyncio.run(read())


def assert_is_log(batches: list[Batch], log: Log) -> None:
    times, indices, values = log.columns()
    assert np.array_equal(np.concatenate([batch.time_ns for batch in batches]), times)
    assert np.array_equal(np.concatenate([batch.signal_index for batch in batches]), indices)
    assert np.array_equal(np.concatenate([batch.value for batch in batches]), values)


@pytest.fixture(scope="module")
def cell_log(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Log]:
    path = tmp_path_factory.mktemp("replay") / "cell.parquet"
    simulated(cycles=4).write(path)
    # Reading numbers the signals in the order of the file.
    return path, read_log(path)


@pytest.mark.parametrize("speed", ["1", "10", "0.5", "1000", "0", "max"])
def test_every_row_of_the_log_in_its_order_and_with_its_time(
    cell_log: tuple[Path, Log], speed: str
) -> None:
    path, log = cell_log
    tap, batches, _ = replayed(f"replay:{path}?speed={speed}")
    assert [signal.name for signal in tap.signals] == log.signals
    assert_is_log(batches, log)
    assert len(batches[-1]) == 0
    assert batches[-1].until_ns == log.engine.end_ns


def test_rows_come_when_the_clock_says(cell_log: tuple[Path, Log]) -> None:
    path, log = cell_log
    _, batches, came = replayed(f"replay:{path}?speed=10")
    first_ns = log.engine.start_ns
    assert first_ns is not None
    for batch, came_ns in zip(batches, came, strict=True):
        for time_ns in batch.time_ns[:1]:
            assert came_ns == START_NS + -(-(int(time_ns) - first_ns) // 10)


def test_time_goes_on_between_rows_but_not_past_the_next(cell_log: tuple[Path, Log]) -> None:
    path, _ = cell_log
    _, batches, came = replayed(f"replay:{path}?speed=1")
    assert max(np.diff(came)) <= QUIET_NS
    assert any(len(batch) == 0 for batch in batches[:-1])
    until_ns = 0
    for batch in batches:
        assert (batch.time_ns > until_ns).all()
        assert batch.until_ns >= until_ns
        until_ns = batch.until_ns


def test_without_pace_no_time_passes(cell_log: tuple[Path, Log]) -> None:
    path, _ = cell_log
    clock = FakeClock()
    replayed(f"replay:{path}?speed=max", clock)
    assert clock.now_ns() == START_NS


def test_a_replay_is_iterated_without_being_entered(cell_log: tuple[Path, Log]) -> None:
    path, log = cell_log

    async def read() -> list[Batch]:
        return [batch async for batch in open_tap(f"replay:{path}?speed=max")]

    assert_is_log(asyncio.run(read()), log)


class GapLog:
    """As much of a log as the cuts look at, with gaps."""

    def __init__(self, times: list[int], gaps: list[tuple[int, int]], signals: int = 2) -> None:
        self._times = times
        self.signals = [f"S{index}" for index in range(signals)]
        self.engine = self
        self.gaps = gaps

    def columns(self) -> tuple[object, object, object]:
        size = len(self._times)
        return (
            np.array(self._times, np.int64),
            np.arange(size, dtype=np.uint32) % len(self.signals),
            np.arange(size, dtype=np.int64),
        )


def cut(log: GapLog, reached: Callable[[int], int | None] = lambda next_ns: None) -> list[Batch]:
    cuts = ReplayCuts(log)  # type: ignore[arg-type]
    batches = []
    while (next_ns := cuts.next_ns) is not None:
        batches.append(cuts.take(reached(next_ns)))
    return [*batches, cuts.last()]


def test_declared_gaps_become_marks_of_the_batch_after_them() -> None:
    batches = cut(GapLog([1, 1, 5, 10, 50, 50, 60, 90], [(10, 50), (60, 80), (90, 99)]))
    told = [
        (
            batch.time_ns.tolist(),
            batch.image,
            [(mark.start_ns, mark.end_ns) for mark in gaps_of(batch)],
        )
        for batch in batches
    ]
    assert told == [
        ([1, 1], True, []),
        ([5, 10], False, []),
        ([50, 50], True, [(10, 50)]),
        ([60], False, []),
        ([90], False, [(60, 80)]),
        ([], False, [(90, 99)]),
    ]
    assert batches[-1].until_ns == 99


def gaps_of(batch: Batch) -> list[Gap]:
    return [mark for mark in batch.marks if isinstance(mark, Gap)]


def test_time_does_not_go_on_in_a_gap() -> None:
    cuts = ReplayCuts(GapLog([1, 1, 100], [(40, 90)]))  # type: ignore[arg-type]
    cuts.take(1)
    assert [cuts.quiet_until_ns(reached) for reached in (30, 60, 95)] == [30, 40, 40]


@settings(max_examples=200)
@given(
    st.lists(st.integers(0, 40), min_size=1, max_size=80).map(sorted),
    st.lists(st.tuples(st.integers(0, 40), st.integers(1, 9)), max_size=3),
    st.integers(0, 30),
    st.integers(1, 20),
)
def test_cut_anywhere_the_rows_are_the_log_and_times_stay_together(
    times: list[int], gaps: list[tuple[int, int]], ahead: int, most: int
) -> None:
    log = GapLog(times, [(start, start + length) for start, length in sorted(gaps)])
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(replay_cuts, "MOST_ROWS", most)
        batches = cut(log, lambda next_ns: next_ns + ahead)
    assert np.concatenate([batch.value for batch in batches]).tolist() == list(range(len(times)))
    assert sorted(gap.start_ns for batch in batches for gap in gaps_of(batch)) == sorted(
        start for start, _ in gaps
    )
    until_ns = -1
    for batch in batches[:-1]:
        assert len(batch)
        assert (batch.time_ns > until_ns).all()
        assert batch.until_ns == batch.time_ns[-1]
        until_ns = batch.until_ns
        for gap in gaps_of(batch):
            assert gap.start_ns < batch.time_ns[0]


def test_classes_and_types_are_guessed_from_names_and_values(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text(
        "time,signal,value\n"
        "2026-03-01T06:00:00Z,%IX0.0,1\n2026-03-01T06:00:01Z,%QX0.0,0\n"
        "2026-03-01T06:00:02Z,M1.0,1\n2026-03-01T06:00:03Z,A1.2,1\n"
        "2026-03-01T06:00:04Z,Magazine-Full,-7\n2026-03-01T06:00:05Z,%MW3,40000\n"
        "2026-03-01T06:00:06Z,%ML3,9000000000\n",
        encoding="utf-8",
    )
    tap, _, _ = replayed(f"replay:{tmp_path}/log.csv?speed=max")
    told = {signal.name: (signal.signal_class, signal.type) for signal in tap.signals}
    assert told == {
        "%IX0.0": ("input", "BOOL"),
        "%QX0.0": ("output", "BOOL"),
        "M1.0": ("memory", "BOOL"),
        "A1.2": ("output", "BOOL"),
        "Magazine-Full": ("input", "INT"),
        "%MW3": ("memory", "DINT"),
        "%ML3": ("memory", "LINT"),
    }


@pytest.mark.parametrize("speed", ["fast", "-1", "inf", "nan", ""])
def test_a_speed_that_is_none_is_refused(speed: str) -> None:
    with pytest.raises(InputError, match="is no speed; write 10"):
        open_tap(f"replay:log.csv?speed={speed}")


def test_a_replay_of_nothing_is_refused() -> None:
    with pytest.raises(InputError, match="names no file"):
        open_tap("replay:?speed=10")


def test_a_file_that_is_no_log_is_refused(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_bytes(b"\0\xff\0\xff")
    with pytest.raises(InputError):
        replayed(f"replay:{tmp_path}/log.csv")
