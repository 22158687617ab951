"""The scanner on a fake device and a fake clock: nothing here waits, and nothing depends on it."""

import asyncio
import itertools
from collections.abc import Callable
from contextlib import aclosing

import numpy as np
import pytest

from runglight.errors import InputError
from runglight.taps import clock as clocks
from runglight.taps.backoff import Backoff
from runglight.taps.base import QUIET_NS, Batch, ClockStep, Connection, ConnectionState, Gap
from runglight.taps.clock import Clock, SteadyClock
from runglight.taps.device import DeviceLostError, WrongAnswerError
from runglight.taps.scanner import Scanner
from tests.taps.fakes import MS, START_NS, FakeClock, FakeDevice

INTERVAL_NS = 10 * MS
HOUR_NS = 3_600_000_000_000


class Run:
    """Scans until `enough` batches came; keeps everything there is to see."""

    def __init__(
        self,
        device: FakeDevice,
        enough: int,
        clock: Clock | None = None,
        interval_ns: int = INTERVAL_NS,
    ) -> None:
        self.clock = clock or FakeClock()
        self.connections: list[Connection] = []
        self.batches: list[Batch] = []
        scanner = Scanner(
            device, self.clock, interval_ns, self.connections.append, Backoff(lambda: 0.5)
        )
        asyncio.run(self._read(scanner, enough))
        assert not device.is_open

    async def _read(self, scanner: Scanner, enough: int) -> None:
        async with aclosing(scanner.batches()) as batches:
            async for batch in batches:
                self.batches.append(batch)
                if len(self.batches) == enough:
                    return

    @property
    def scan_ns(self) -> list[int]:
        return [int(scan) for batch in self.batches for scan in batch.scan_ns]


def spending(clock: FakeClock, milliseconds: float, image: bytes = b"\0") -> Callable[[], bytes]:
    """A read that takes its time."""

    def read() -> bytes:
        clock.time_ns += round(milliseconds * MS)
        return image

    return read


def test_scans_lie_on_the_grid_and_are_stamped_after_the_reply() -> None:
    clock = FakeClock()
    device = FakeDevice([spending(clock, 2) for _ in range(30)])
    run = Run(device, 3, clock)
    assert run.scan_ns[:4] == [START_NS + k * INTERVAL_NS + 2 * MS for k in range(4)]


def test_scans_overslept_are_left_out_and_not_made_up_for() -> None:
    clock = FakeClock()
    device = FakeDevice([b"\0", spending(clock, 34), *(spending(clock, 1) for _ in range(20))])
    run = Run(device, 2, clock)
    # The scan due at 10 ms ends at 44 ms: the next ones are due at 50 and 60 ms.
    assert run.scan_ns[:4] == [START_NS + at * MS for at in (0, 44, 51, 61)]


def test_with_interval_zero_it_scans_as_fast_as_it_goes() -> None:
    clock = FakeClock()
    device = FakeDevice([spending(clock, 0.25) for _ in range(2_000)])
    run = Run(device, 3, clock, interval_ns=0)
    assert set(np.diff(run.scan_ns)) == {MS // 4}


def test_idle_scans_share_a_batch_and_no_silence_is_longer_than_it_may_be() -> None:
    run = Run(FakeDevice([]), 20)
    untils = [batch.until_ns for batch in run.batches]
    assert max(np.diff(untils)) <= QUIET_NS
    assert [len(batch) for batch in run.batches] == [4, *[0] * 19]
    assert [len(batch.scan_ns) for batch in run.batches[1:]] == [9] * 19
    assert run.scan_ns == [START_NS + k * INTERVAL_NS for k in range(len(run.scan_ns))]


def test_a_change_makes_a_batch_at_once_with_the_idle_scans_before_it() -> None:
    run = Run(FakeDevice([b"\0", b"\0", b"\0", b"\x05", b"\x04"]), 3)
    first, change, back = run.batches
    assert first.image
    assert not change.image
    assert len(change.scan_ns) == 3
    assert change.signal_index.tolist() == [0, 2]
    assert change.value.tolist() == [1, 1]
    assert change.time_ns.tolist() == [START_NS + 3 * INTERVAL_NS] * 2
    assert change.until_ns == START_NS + 3 * INTERVAL_NS
    assert (back.signal_index.tolist(), back.value.tolist()) == ([0], [0])


def test_the_scans_after_a_change_leave_at_once() -> None:
    run = Run(FakeDevice([b"\0", b"\0", b"\1", b"\1", b"\1", b"\1", b"\0"]), 5)
    _, _, after, again, change = run.batches
    # They end the scan before for whoever watches; then quiet is shared again.
    assert (len(after), len(after.scan_ns)) == (0, 1)
    assert after.until_ns == START_NS + 3 * INTERVAL_NS
    assert (len(again), len(again.scan_ns)) == (0, 1)
    assert (len(change), len(change.scan_ns)) == (1, 2)


def test_bits_beyond_the_signals_are_no_change() -> None:
    run = Run(FakeDevice([b"\x00", b"\xf0"]), 2)
    assert len(run.batches[1]) == 0


def test_one_wrong_answer_is_asked_again_and_never_turned_into_values() -> None:
    device = FakeDevice([b"\x01", WrongAnswerError("short"), b"\x03"])
    run = Run(device, 2)
    assert device.connects == 1
    assert not run.batches[1].marks
    assert run.batches[1].signal_index.tolist() == [1]
    assert [connection.state for connection in run.connections] == [ConnectionState.CONNECTED]


def test_two_wrong_answers_in_a_row_are_a_lost_connection() -> None:
    device = FakeDevice([b"\x01", WrongAnswerError("short"), WrongAnswerError("shorter"), b"\x01"])
    run = Run(device, 2)
    assert device.connects == 2
    (gap,) = run.batches[1].marks
    assert isinstance(gap, Gap)
    assert "shorter" in gap.reason
    assert run.batches[1].image


def test_a_gap_runs_from_the_last_good_scan_to_the_first_and_an_image_follows() -> None:
    lost = DeviceLostError("no reply in 0.5 s")
    device = FakeDevice([b"\0", b"\0", b"\0", lost, lost, b"\x02"])
    run = Run(device, 3)
    _, idle, back = run.batches
    assert idle.until_ns == START_NS + 2 * INTERVAL_NS
    (gap,) = back.marks
    assert gap == Gap(idle.until_ns, int(back.time_ns[0]), "no reply in 0.5 s")
    assert back.image
    assert back.value.tolist() == [0, 1, 0, 0]
    assert [connection.state for connection in run.connections] == [
        ConnectionState.CONNECTED,
        ConnectionState.RETRYING,
        ConnectionState.RETRYING,
        ConnectionState.CONNECTED,
    ]
    assert run.connections[1].reason == "no reply in 0.5 s"
    assert run.connections[-1] == Connection(ConnectionState.CONNECTED, 1, None)
    # One interval to the scan that was lost, and waits of 0.1 and 0.2 s.
    assert gap.end_ns - gap.start_ns == INTERVAL_NS + 300 * MS


def test_no_gap_before_the_first_scan() -> None:
    device = FakeDevice([])
    device.refusals = [DeviceLostError("refused"), DeviceLostError("refused")]
    run = Run(device, 1)
    assert run.batches[0].marks == ()
    assert run.batches[0].image
    assert run.connections[-1].reconnects == 0


def test_a_device_that_connects_and_never_answers_is_left_alone_more_and_more() -> None:
    clock = FakeClock()
    device = FakeDevice([b"\0", *(DeviceLostError("no reply in 0.5 s") for _ in range(8))])
    run = Run(device, 2, clock)
    waits = [
        round((later - earlier) / MS)
        for earlier, later in itertools.pairwise(clock.slept_until_ns)
        if later - earlier >= 90 * MS
    ]
    assert waits == [100, 200, 400, 800, 1600, 3200, 5000, 5000]
    assert len(run.batches[1].marks) == 1


def test_after_a_good_scan_the_waits_are_short_again() -> None:
    clock = FakeClock()
    lost = DeviceLostError("no reply in 0.5 s")
    run = Run(FakeDevice([b"\0", lost, lost, b"\0", lost, b"\0"]), 3, clock)
    gaps = [mark for batch in run.batches for mark in batch.marks if isinstance(mark, Gap)]
    assert [gap.end_ns - gap.start_ns for gap in gaps] == [310 * MS, 110 * MS]
    assert run.connections[-1].reconnects == 2


@pytest.mark.parametrize(
    ("interval_ms", "slow_ms", "is_gap"),
    [
        (10, 90, False),
        (10, 110, True),
        (10, 1_100, True),
        (1_000, 4_000, False),
        (1_000, 5_100, True),
    ],
)
def test_changes_seen_after_a_long_stretch_are_a_gap(
    interval_ms: int, slow_ms: int, is_gap: bool
) -> None:
    clock = FakeClock()
    device = FakeDevice([b"\0", spending(clock, slow_ms, b"\x08"), b"\x08"])
    run = Run(device, 2, clock, interval_ns=interval_ms * MS)
    slow = run.batches[1]
    assert slow.image is is_gap
    assert len(slow) == (4 if is_gap else 1)
    if is_gap:
        (gap,) = slow.marks
        assert isinstance(gap, Gap)
        assert (gap.start_ns, gap.end_ns) == (START_NS, slow.until_ns)
        assert "too slow" in gap.reason
    assert len(run.connections) == 1


@pytest.mark.parametrize(("slow_ms", "is_gap"), [(900, False), (1_100, True)])
def test_a_stretch_in_which_nothing_changed_may_be_longer(slow_ms: int, is_gap: bool) -> None:
    clock = FakeClock()
    device = FakeDevice([b"\0", spending(clock, slow_ms), b"\0", b"\1"])
    run = Run(device, 4, clock)
    gaps = [mark for batch in run.batches for mark in batch.marks if isinstance(mark, Gap)]
    assert bool(gaps) is is_gap


@pytest.mark.parametrize("step_ns", [HOUR_NS, -HOUR_NS])
def test_a_clock_set_by_an_hour_is_a_mark_and_no_time_lost(
    monkeypatch: pytest.MonkeyPatch, step_ns: int
) -> None:
    shift = {"ns": 0}
    real = clocks.time.time_ns
    monkeypatch.setattr(clocks.time, "time_ns", lambda: real() + shift["ns"])

    def stepped() -> bytes:
        shift["ns"] = step_ns
        return b"\0"

    run = Run(FakeDevice([b"\0", b"\0", stepped, b"\x01"]), 4, SteadyClock(), interval_ns=MS)
    marks = [mark for batch in run.batches for mark in batch.marks]
    (mark,) = marks
    assert isinstance(mark, ClockStep)
    assert abs(mark.step_ns - step_ns) < 100 * MS
    times = run.scan_ns
    assert times == sorted(times)
    assert times[-1] - times[0] < HOUR_NS // 2
    # What was seen before the step is told before it.
    told = next(batch for batch in run.batches if batch.marks)
    assert told.scan_ns.tolist() == [mark.time_ns]
    assert not told.image


def test_what_can_never_work_ends_the_iteration() -> None:
    device = FakeDevice([])
    device.refusals = [InputError("the device has no coils 100-199")]
    with pytest.raises(InputError, match="no coils"):
        Run(device, 1)
    assert not device.is_open


def test_time_that_runs_backwards_is_held() -> None:
    clock = FakeClock()
    device = FakeDevice([b"\0", spending(clock, -50, b"\x01"), b"\x03"])
    run = Run(device, 3, clock)
    times = [int(batch.time_ns[0]) for batch in run.batches]
    assert times == sorted(times)
