"""Batches from values, images and losses, with a clock the tests set."""

from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from runglight.taps.arrivals import Arrivals
from runglight.taps.base import QUIET_NS, Batch, ClockStep, Gap
from tests.taps.listening import check_order

MS = 1_000_000
START = 1_800_000_000_000_000_000


class HandClock:
    def __init__(self) -> None:
        self.time_ns = START
        self.step_ns: int | None = None

    def now_ns(self) -> int:
        return self.time_ns

    async def sleep_until(self, time_ns: int) -> None:
        raise NotImplementedError

    def take_step_ns(self) -> int | None:
        step_ns, self.step_ns = self.step_ns, None
        return step_ns


def rows(batches: list[Batch]) -> list[tuple[int, int, int]]:
    return [
        row
        for batch in batches
        for row in zip(
            ((batch.time_ns - START) // MS).tolist(),
            batch.signal_index.tolist(),
            batch.value.tolist(),
            strict=True,
        )
    ]


def started(*, stamped: bool = True) -> tuple[HandClock, Arrivals]:
    clock = HandClock()
    arrivals = Arrivals(clock, 200 * MS, stamped=stamped)
    arrivals.image({1: 10, 0: 0})
    return clock, arrivals


def test_the_image_comes_first_and_whole() -> None:
    _, arrivals = started()
    [image] = arrivals.take()
    assert image.image
    assert image.marks == ()
    assert rows([image]) == [(0, 0, 0), (0, 1, 10)]


def test_values_are_sorted_within_the_window() -> None:
    clock, arrivals = started()
    batches = arrivals.take()
    clock.time_ns += 100 * MS
    arrivals.value(0, 1, START + 90 * MS)
    arrivals.value(1, 11, START + 40 * MS)
    clock.time_ns += 50 * MS
    arrivals.value(1, 12, START + 60 * MS)
    clock.time_ns += 200 * MS
    batches += arrivals.take()
    assert rows(batches)[2:] == [(40, 1, 11), (60, 1, 12), (90, 0, 1)]
    assert arrivals.late == 0
    check_order(batches)


def test_a_late_value_is_stamped_at_the_edge_and_counted() -> None:
    clock, arrivals = started()
    batches = arrivals.take()
    clock.time_ns += 1000 * MS
    batches += arrivals.take()
    arrivals.value(0, 1, clock.time_ns - MS)
    arrivals.value(1, 12, START + 100 * MS)
    clock.time_ns += 300 * MS
    batches += arrivals.take()
    assert [row[1:] for row in rows(batches)[2:]] == [(1, 12), (0, 1)]
    assert arrivals.late == 1
    check_order(batches)


def test_values_without_stamps_do_not_wait() -> None:
    clock, arrivals = started(stamped=False)
    arrivals.take()
    clock.time_ns += 5 * MS
    arrivals.value(0, 1)
    assert rows(arrivals.take()) == [(5, 0, 1)]


def test_silence_is_told_as_time_that_goes_on() -> None:
    for stamped in (True, False):
        clock, arrivals = started(stamped=stamped)
        batches = arrivals.take()
        told = [clock.time_ns]
        for _ in range(1000):
            clock.time_ns += MS
            if clock.time_ns >= arrivals.next_due_ns() and (new := arrivals.take()):
                batches += new
                told.append(clock.time_ns)
        assert max(later - now for now, later in pairwise(told)) <= QUIET_NS
        assert clock.time_ns - batches[-1].until_ns <= 200 * MS + QUIET_NS
        check_order(batches)


def test_a_loss_is_a_gap_from_the_last_word_to_the_image() -> None:
    clock, arrivals = started()
    batches = arrivals.take()
    clock.time_ns += 10 * MS
    arrivals.value(0, 1, clock.time_ns)
    clock.time_ns += 500 * MS
    arrivals.lost("the plug was pulled")
    batches += arrivals.take()
    clock.time_ns += 1000 * MS
    assert arrivals.take() == []
    arrivals.lost("nobody answers")
    clock.time_ns += 1000 * MS
    arrivals.image({0: 0})
    batches += arrivals.take()
    assert rows(batches)[2:] == [(10, 0, 1), (2510, 0, 0)]
    assert batches[-1].marks == (Gap(START + 10 * MS, START + 2510 * MS, "the plug was pulled"),)
    assert batches[-1].image
    check_order(batches)


def test_a_loss_before_the_first_word_is_no_gap() -> None:
    clock = HandClock()
    arrivals = Arrivals(clock, 0)
    arrivals.lost("nobody answers")
    arrivals.image({0: 1})
    [image] = arrivals.take()
    assert image.marks == ()


def test_a_part_that_was_not_seen_is_a_gap_after_the_last_row() -> None:
    clock, arrivals = started()
    batches = arrivals.take()
    arrivals.forget([1])
    clock.time_ns += 50 * MS
    arrivals.value(0, 5, clock.time_ns)
    clock.time_ns += 50 * MS
    arrivals.resume({1: 99}, START + 20 * MS, "device B was away")
    batches += arrivals.take()
    assert rows(batches)[2:] == [(50, 0, 5), (100, 0, 5), (100, 1, 99)]
    assert batches[-1].marks == (Gap(START + 50 * MS, START + 100 * MS + 1, "device B was away"),)
    check_order(batches)


def test_a_step_of_the_computers_clock_lies_between_the_rows_before_and_after() -> None:
    clock, arrivals = started()
    batches = arrivals.take()
    arrivals.value(0, 1, clock.time_ns)
    clock.time_ns += 20 * MS
    clock.step_ns = 3_600_000 * MS
    batches += arrivals.take()
    arrivals.value(0, 0, clock.time_ns)
    clock.time_ns += 300 * MS
    batches += arrivals.take()
    marked = [number for number, batch in enumerate(batches) if batch.marks]
    assert len(marked) == 1
    assert batches[marked[0]].marks == (ClockStep(START + 20 * MS, 3_600_000 * MS),)
    assert [row[2] for row in rows(batches[1 : marked[0]])] == [1]
    check_order(batches)


ACTIONS = st.lists(
    st.tuples(
        st.sampled_from(["value", "value", "value", "take", "image", "lost", "resume"]),
        st.integers(0, 3),
        st.integers(-400, 400) | st.none(),
        st.integers(0, 150),
    ),
    max_size=60,
)


@given(ACTIONS, st.booleans())
def test_whatever_comes_rows_are_in_order_and_none_is_lost(
    actions: list[tuple[str, int, int | None, int]], stamped: bool
) -> None:
    clock, arrivals = started(stamped=stamped)
    batches = arrivals.take()
    sent = 0
    connected = True
    for kind, signal, stamp_ms, passed_ms in actions:
        clock.time_ns += passed_ms * MS
        if kind == "value" and connected:
            sent += 1
            stamp_ns = None if stamp_ms is None else clock.time_ns + stamp_ms * MS
            arrivals.value(signal, 1000 + sent, stamp_ns)
        elif kind == "image" and not connected:
            arrivals.image({signal: 1})
            connected = True
        elif kind == "resume" and connected:
            arrivals.resume({signal: 1}, clock.time_ns - 50 * MS, "away")
        elif kind == "lost":
            arrivals.lost("gone")
            connected = False
        elif kind == "take":
            batches += arrivals.take()
    clock.time_ns += 1000 * MS
    arrivals.lost("the end")
    batches += arrivals.take()
    check_order(batches)
    came = [value for batch in batches if not batch.image for value in batch.value.tolist()]
    assert sorted(came) == list(range(1001, 1001 + sent))
