from hypothesis import given
from hypothesis import strategies as st

from runglight.taps.grid import Grid


def test_the_first_slot_is_now() -> None:
    assert Grid(10).next_ns(1_234) == 1_234


@given(st.integers(1, 1_000), st.lists(st.integers(0, 5_000), max_size=50))
def test_slots_lie_on_the_grid_ahead_of_now_and_by_less_than_an_interval(
    interval: int, spent: list[int]
) -> None:
    grid = Grid(interval)
    slot = first = grid.next_ns(77)
    for spend in spent:
        now = slot + spend
        following = grid.next_ns(now)
        assert (following - first) % interval == 0
        assert following > slot
        assert now <= following <= max(now, slot) + interval
        slot = following


def test_without_an_interval_every_slot_is_now() -> None:
    grid = Grid(0)
    assert [grid.next_ns(now) for now in (5, 5, 9)] == [5, 5, 9]
