"""A stretch departs only where no order of the events of its scans is known."""

from runglight.injection.departure import Departure, Step, first_departure

STATES = 10


def departure(
    known: list[tuple[int, int]], *steps: tuple[int, int], before: tuple[int, ...] = (0,)
) -> Departure | None:
    codes = {current * STATES + following for current, following in known}
    return first_departure(list(before), [Step(*step) for step in steps], codes, STATES, 10)


def test_a_known_way_is_no_departure() -> None:
    assert departure([(0, 1), (1, 2)], (100, 1), (200, 2)) is None


def test_the_first_unknown_transition_is_named() -> None:
    assert departure([(0, 1)], (100, 1), (200, 2), (300, 3)) == Departure(200, 1, 2)


def test_events_of_one_scan_may_stand_in_any_order() -> None:
    known = [(0, 1), (1, 2), (2, 3)]
    assert departure(known, (100, 2), (109, 1), (200, 3)) is None
    assert departure(known, (100, 2), (109, 1), (200, 4)) == Departure(100, 0, 2)
    assert departure(known, (100, 2), (105, 1)) is None
    assert departure(known, (100, 2), (110, 1)) == Departure(100, 0, 2)


def test_so_may_those_of_the_scan_before() -> None:
    assert departure([(5, 1)], (100, 1), before=(5, 0)) is None
    assert departure([(6, 1)], (100, 1), before=(5, 0)) == Departure(100, 0, 1)


def test_scans_too_large_to_try_are_left_alone() -> None:
    assert departure([], *((100, state) for state in range(1, 8))) is None
