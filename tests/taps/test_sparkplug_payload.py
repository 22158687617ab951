"""The decoder against bytes written by hand, and against an encoder that shares no code with it."""

from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from runglight.taps.sparkplug_payload import (
    DataType,
    Payload,
    PayloadError,
    decode_payload,
    rebirth_request,
)
from tests.taps.sparkplug_edge import TYPES, field, metric, payload

INTEGERS = {
    "Int8": (-(2**7), 2**7 - 1), "Int16": (-(2**15), 2**15 - 1), "Int32": (-(2**31), 2**31 - 1),
    "Int64": (-(2**63), 2**63 - 1), "UInt8": (0, 2**8 - 1), "UInt16": (0, 2**16 - 1),
    "UInt32": (0, 2**32 - 1), "UInt64": (0, 2**63 - 1),
}  # fmt: skip
U64 = st.integers(0, 2**64 - 1)


def test_bytes_written_by_hand() -> None:
    # protoc --encode of: timestamp: 1486144502122 metrics { name: "A" alias: 5 datatype: 3
    # int_value: 4294967289 (that is -7) } seq: 255
    data = bytes.fromhex("08eaf2f5a8a02b120d0a01411005200350f9ffffff0f18ff01")
    decoded = decode_payload(data)
    assert decoded.timestamp_ms == 1_486_144_502_122
    assert decoded.seq == 255
    [only] = decoded.metrics
    assert (only.name, only.alias, only.datatype, only.value(3)) == ("A", 5, 3, -7)


@given(st.data())
def test_what_another_encoder_wrote_is_read(data: st.DataObject) -> None:
    kinds = data.draw(st.lists(st.sampled_from([*INTEGERS, "Boolean"]), max_size=5))
    written = []
    for kind in kinds:
        value = data.draw(st.booleans() if kind == "Boolean" else st.integers(*INTEGERS[kind]))
        name = data.draw(st.none() | st.text(st.characters(exclude_categories=["Cs"])))
        alias, time_ms = data.draw(st.none() | U64), data.draw(st.none() | U64)
        historical = data.draw(st.booleans())
        written.append((kind, value, name, alias, time_ms, historical))
    seq, time_ms = data.draw(st.none() | st.integers(0, 255)), data.draw(U64)
    encoded = payload(
        [
            metric(value, kind, name=name, alias=alias, time_ms=at_ms, historical=historical)
            for kind, value, name, alias, at_ms, historical in written
        ],
        seq,
        time_ms,
    )
    decoded = decode_payload(encoded)
    assert (decoded.seq, decoded.timestamp_ms) == (seq, time_ms)
    assert [
        (one.datatype, one.value(one.datatype or 0), one.name, one.alias, one.timestamp_ms,
         one.historical)
        for one in decoded.metrics
    ] == [(TYPES[kind], int(value), *rest) for kind, value, *rest in written]  # fmt: skip


@given(st.binary(max_size=200))
def test_any_bytes_are_a_payload_or_an_error(data: bytes) -> None:
    try:
        decoded = decode_payload(data)
    except PayloadError:
        return
    else:
        assert isinstance(decoded, Payload)
        for one in decoded.metrics:
            for datatype in range(40):
                value = one.value(datatype)
                assert value is None or -(2**63) <= value < 2**63


@given(st.data())
def test_cut_anywhere_it_is_a_payload_or_an_error(data: st.DataObject) -> None:
    whole = payload([metric(-3, "Int16", name="Step", alias=1), metric(True, "Boolean")], 7, 9)
    cut = data.draw(st.integers(0, len(whole) - 1))
    with suppress(PayloadError):
        decode_payload(whole[:cut])


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"\x08", "middle of a number"),
        (b"\x12\x05a", "middle of a field"),
        (b"\x08" + b"\xff" * 10, "more than ten bytes"),
        (b"\x0b", "unknown kind 3"),
        (b"\x00\x00", "without a number"),
        (b"\x10\x01", "number where bytes"),
        (b"\x0a\x01a", "bytes where a number"),
        (field(2, field(1, b"\xff")), "not text"),
        (field(4, "SPBV1.0_COMPRESSED") + field(5, b"x"), "compressed"),
    ],
)
def test_errors_say_what(data: bytes, said: str) -> None:
    with pytest.raises(PayloadError, match=said):
        decode_payload(data)


def test_unknown_fields_and_other_values_are_passed_over() -> None:
    decoded = decode_payload(
        field(99, "new") + payload([metric(4.7, "Double"), metric("x", "String")], 1, 2)
    )
    assert [one.raw for one in decoded.metrics] == [None, None]


def test_a_null_has_no_value() -> None:
    [one] = decode_payload(payload([metric(None, "Int32", name="A")])).metrics
    assert one.null
    assert one.value(DataType.INT32) is None


def test_the_rebirth_request_is_what_the_specification_says() -> None:
    expected = payload(
        [metric(True, "Boolean", name="Node Control/Rebirth", time_ms=1234567890123)],
        time_ms=1234567890123,
    )
    assert rebirth_request(1234567890123) == expected
