import pytest
from hypothesis import given
from hypothesis import strategies as st

from runglight.errors import InputError
from runglight.taps.ranges import parse_ranges, spelled, split


def test_ranges_are_sorted_and_merged() -> None:
    assert parse_ranges("300-310, 200,0-99,100-120,119", "holding") == [
        range(121),
        range(200, 201),
        range(300, 311),
    ]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "'' is no range"),
        ("a-b", "'a-b' is no range"),
        ("1-2-3", "is no range"),
        ("-5", "is no range"),
        ("5-", None),
        ("9-3", "runs backwards; write 3-9"),
        ("70000", "addresses end at 65535"),
        ("²", "is no range"),
    ],
)
def test_what_is_no_range_is_refused(text: str, said: str | None) -> None:
    with pytest.raises(InputError, match=said) as refused:
        parse_ranges(text, "modbus://plc: coils")
    assert str(refused.value).startswith("modbus://plc: coils: ")


@given(st.sets(st.integers(0, 300), min_size=1))
def test_spelled_ranges_are_read_back(addresses: set[int]) -> None:
    ranges = parse_ranges(spelled(sorted(addresses)), "coils")
    assert [address for numbers in ranges for address in numbers] == sorted(addresses)


@given(st.sets(st.integers(0, 300), min_size=1), st.integers(1, 50))
def test_splitting_keeps_every_address(addresses: set[int], most: int) -> None:
    ranges = parse_ranges(spelled(sorted(addresses)), "coils")
    parts = list(split(ranges, most))
    assert all(0 < len(part) <= most for part in parts)
    assert [address for part in parts for address in part] == sorted(addresses)
