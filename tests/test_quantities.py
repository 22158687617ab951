"""Durations and rates as people write them."""

import pytest

from runglight.errors import InputError
from runglight.quantities import duration_s, rate_per_day


@pytest.mark.parametrize(
    ("text", "seconds"),
    [("90", 90), ("1.5s", 1.5), ("10ms", 0.01), ("3m", 180), ("2 h", 7200), ("1d", 86400)],
)
def test_durations(text: str, seconds: float) -> None:
    assert duration_s(text, "--reorder") == pytest.approx(seconds)


@pytest.mark.parametrize("text", ["", "soon", "-1", "1 fortnight", "nan", "1e999s", "3m2"])
def test_what_is_no_duration(text: str) -> None:
    with pytest.raises(InputError, match=r"--reorder: .* is not a duration"):
        duration_s(text, "--reorder")


@pytest.mark.parametrize(
    ("text", "per_day"),
    [("1/day", 1), ("2/week", 2 / 7), ("0.5/h", 12), ("3 per shift", 9), ("1/D", 1)],
)
def test_rates(text: str, per_day: float) -> None:
    assert rate_per_day(text) == pytest.approx(per_day)


@pytest.mark.parametrize("text", ["", "1", "day", "1/blue moon", "0/day", "-1/day", "x/day"])
def test_what_is_no_rate(text: str) -> None:
    with pytest.raises(InputError, match="--false-alarms: "):
        rate_per_day(text)
