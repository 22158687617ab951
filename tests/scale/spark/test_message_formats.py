"""Messages of a topic: what is read, and what is said of those that cannot be."""

from __future__ import annotations

import json

import numpy as np
import pyarrow as pa
import pytest

from runglight.scale.spark.changes import Changes
from runglight.scale.spark.message_formats import FORMATS
from runglight.scale.wire import GAP, Encoder, encode_binary, encode_json

TIME_NS = 1_767_600_000_123_456_789
ISO = "2026-01-05T08:00:00.123456789Z"


def read(format: str, messages: list[bytes | None]) -> Changes:
    count = len(messages)
    return FORMATS[format](
        pa.array(messages, pa.binary()),
        pa.array(np.full(count, 3, np.int32)),
        pa.array(np.arange(40, 40 + count, dtype=np.int64)),
    )


def arrow_stream(**columns: pa.Array) -> bytes:
    table = pa.table(columns)
    sink = pa.BufferOutputStream()
    with pa.ipc.new_stream(sink, table.schema) as writer:
        writer.write_table(table)
    return bytes(sink.getvalue().to_pybytes())


def rows(changes: Changes) -> list[tuple[int, str | None, int, str]]:
    return list(
        zip(
            changes.time_ns.tolist(),
            changes.signal.to_pylist(),
            changes.value.tolist(),
            changes.plant.to_pylist(),
            strict=True,
        )
    )


@pytest.mark.parametrize("time", [ISO, TIME_NS, str(TIME_NS)])
def test_json(time: object) -> None:
    changes = read(
        "json",
        [
            json.dumps({"time": time, "signal": "A", "value": 1}).encode(),
            json.dumps({"time": time, "signal": "B", "value": True, "plant": "north"}).encode(),
            json.dumps({"time": time}).encode(),
        ],
    )
    assert rows(changes) == [
        (TIME_NS, "A", 1, ""),
        (TIME_NS, "B", 1, "north"),
        (TIME_NS, None, 0, ""),
    ]
    assert changes.partition.tolist() == [3, 3, 3]
    assert changes.offset == 40
    assert changes.unreadable == 0


@pytest.mark.parametrize(
    ("message", "reason"),
    [
        (b"{", "is no change"),
        (None, "is empty"),
        (b'{"time": 1, "signal": "A", "value": 0.5}', "measurement"),
        (b'{"signal": "A", "value": 1}', "is no change"),
        (b'{"time": "yesterday", "signal": "A", "value": 1}', "no time that can be read"),
        (b'{"time": 1, "signal": "A", "value": 1},{"time": 1}', "is no change"),
        (b"\xff\xfe", "is no change"),
    ],
)
def test_json_that_is_no_change(message: bytes | None, reason: str) -> None:
    good = json.dumps({"time": TIME_NS, "signal": "A", "value": 1}).encode()
    changes = read("json", [good, message, good])
    assert rows(changes) == [(TIME_NS, "A", 1, "")] * 2
    assert changes.unreadable == 1
    assert reason in changes.first


def test_json_values_as_mqtt_writes_them() -> None:
    text = b'{"time": %d, "signal": "A", "value": "%s"}'
    changes = read("json", [text % (TIME_NS, word) for word in (b"ON", b"off", b"7")])
    assert changes.value.tolist() == [1, 0, 7]


def test_binary() -> None:
    changes = read(
        "binary",
        [encode_binary(TIME_NS, "Grüße", -5), b"short", encode_binary(TIME_NS + 1, "", 0)],
    )
    assert rows(changes) == [(TIME_NS, "Grüße", -5, ""), (TIME_NS + 1, None, 0, "")]
    assert (changes.unreadable, changes.first) == (
        1,
        "(partition 3, offset 41) has 5 bytes, not 16 or more",
    )


def test_binary_with_a_name_that_is_no_text() -> None:
    changes = read("binary", [encode_binary(TIME_NS, "A", 1), b"\0" * 16 + b"\xff"])
    assert rows(changes) == [(TIME_NS, "A", 1, "")]
    assert changes.unreadable == 1


@pytest.mark.parametrize(("format", "encode"), [("json", encode_json), ("binary", encode_binary)])
def test_what_is_written_is_read(format: str, encode: Encoder) -> None:
    written = [(TIME_NS, "Grüße", 7), (TIME_NS, "", 0), (TIME_NS + 9, GAP, TIME_NS + 5)]
    changes = read(format, [encode(*row) for row in written])
    assert rows(changes) == [(at, name or None, value, "") for at, name, value in written]


def test_arrow() -> None:
    message = arrow_stream(
        time=pa.array([TIME_NS, TIME_NS + 1], pa.timestamp("ns", "UTC")),
        signal=pa.array(["A", None]).dictionary_encode(),
        value=pa.array([True, False]),
    )
    changes = read("arrow", [message, b"nothing of the kind", message])
    assert rows(changes) == [(TIME_NS, "A", 1, ""), (TIME_NS + 1, None, 0, "")] * 2
    assert changes.unreadable == 1
    assert "is no Arrow stream" in changes.first


@pytest.mark.parametrize("format", sorted(FORMATS))
def test_nothing(format: str) -> None:
    assert len(read(format, [])) == 0
