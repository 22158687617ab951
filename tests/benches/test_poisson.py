"""Exact bounds of a rate (`benches.poisson`)."""

import pytest

from benches.poisson import at_most, lower_bound, upper_bound


@pytest.mark.parametrize(
    ("count", "lower", "upper"),
    [(0, 0.0, 2.9957), (1, 0.0513, 4.7439), (10, 5.4254, 16.9622)],
)
def test_bounds_are_those_of_the_tables(count: int, lower: float, upper: float) -> None:
    assert lower_bound(count) == pytest.approx(lower, abs=2e-4)
    assert upper_bound(count) == pytest.approx(upper, abs=2e-4)


@pytest.mark.parametrize("count", [1, 7, 100])
def test_a_bound_leaves_one_in_twenty(count: int) -> None:
    assert at_most(count, upper_bound(count)) == pytest.approx(0.05)
    assert at_most(count - 1, lower_bound(count)) == pytest.approx(0.95)


def test_probabilities_end_at_one() -> None:
    assert at_most(3, 0.0) == 1.0
    assert at_most(60, 10.0) == pytest.approx(1.0)
