import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from runglight.taps.mqtt_payload import read_payload, read_time

NOON_NS = 1_767_268_800_000_000_000  # 2026-01-01T12:00:00Z


@pytest.mark.parametrize(
    ("payload", "value"),
    [
        ("1", 1), ("0", 0), ("-7", -7), ("+3", 3), (" 12\n", 12),
        ("true", 1), ("False", 0), ("ON", 1), ("off", 0), ('"ON"', 1), ('"7"', 7),
        ('{"value": true}', 1), ('{"Value": 5, "unit": "mm"}', 5), ('{"v": "OFF"}', 0),
        (str(2**63 - 1), 2**63 - 1), (str(-(2**63)), -(2**63)),
    ],
)  # fmt: skip
def test_values(payload: str, value: int) -> None:
    [member] = read_payload(payload.encode())
    assert (member.name, member.value) == ("", value)


@pytest.mark.parametrize(
    ("payload", "reason"),
    [
        (b"4.7", "float"), (b'{"value": 1.0}', "float"), (b"A7", "text"), (b"", "empty"),
        (b"null", "null"), (b"[1]", "list"), (b'{"value": {"a": 1}}', "object"), (b"{}", "object"),
        (b"\xff\xfe", "not text"), (str(2**63).encode(), "64-bit"), (b"{broken", "text"),
        (b"[" * 100_000, "text"),
    ],
)  # fmt: skip
def test_what_is_left_out(payload: bytes, reason: str) -> None:
    [member] = read_payload(payload)
    assert member.value is None
    assert reason in member.reason


def test_a_flat_object_is_several_members() -> None:
    members = read_payload(b'{"Clamp": true, "Step": 12, "Load": 1.5, "ts": 1767268800000}')
    assert [(member.name, member.value, member.stamp_ns) for member in members] == [
        ("Clamp", 1, NOON_NS),
        ("Step", 12, NOON_NS),
        ("Load", None, None),
    ]


def test_a_member_called_t_that_is_no_time_is_a_signal() -> None:
    members = read_payload(b'{"t": true, "Step": 1}')
    assert [(member.name, member.value, member.stamp_ns) for member in members] == [
        ("t", 1, None),
        ("Step", 1, None),
    ]


@pytest.mark.parametrize(
    "written",
    [
        NOON_NS, NOON_NS // 1000, NOON_NS // 10**6, NOON_NS // 10**9, NOON_NS / 10**9,
        str(NOON_NS // 10**6), "2026-01-01T12:00:00Z", "2026-01-01 12:00:00",
        "2026-01-01T13:00:00+01:00",
    ],
)  # fmt: skip
def test_times(written: object) -> None:
    assert read_time(written) == NOON_NS


@pytest.mark.parametrize("written", ["noon", None, True, -1, float("inf"), float("nan"), [], 1e300])
def test_what_is_no_time(written: object) -> None:
    assert read_time(written) is None


@given(st.binary())
def test_any_bytes_are_members(payload: bytes) -> None:
    for member in read_payload(payload):
        assert (member.value is None) == bool(member.reason)


@given(
    st.recursive(
        st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
        lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
        max_leaves=8,
    )
)
def test_any_json_is_members(content: object) -> None:
    for member in read_payload(json.dumps(content).encode()):
        assert (member.value is None) == bool(member.reason)
        assert member.value is None or -(2**63) <= member.value < 2**63
