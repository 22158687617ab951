r"""What a message on the wire holds: one change as JSON or binary, or many as an Arrow stream.

- `json`: `{"time": "2026-01-31T06:00:00.123Z", "signal": "PRT_CHK", "value": 1}`; `time` as ISO
  8601 or as a number since 1970 (s, ms, us, ns by its size), `value` an integer or a boolean,
  `plant` where the topic has several. Without a `signal` it is a heartbeat, and with `gap` it says
  that nothing was recorded from then to `time`.
- `binary`: int64 nanoseconds since 1970, int64 value, both little-endian, then the signal's name in
  UTF-8 to the end. Without a name it is a heartbeat; the name `\0gap` makes the value the start of
  a gap that ends at the time.
- `arrow`: an Arrow IPC stream with columns `time` (timestamp or int64 nanoseconds), `signal`,
  `value`, and `plant` where there are several.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import msgspec
import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from runglight.scale.spark.changes import Changes, everywhere, names
from runglight.scale.wire import GAP
from runglight.taps.mqtt_payload import read_payload, read_time

FIXED = 16
"""Bytes before the name: time and value."""


class _Message(msgspec.Struct, gc=False):
    time: str | int | float
    signal: str | None = None
    value: bool | int = 0
    plant: str | None = None
    gap: str | int | float | None = None


_all = msgspec.json.Decoder(list[_Message])
_one = msgspec.json.Decoder(_Message)

Decoder = Callable[[Any, Any, Any], Changes]
"""Takes values (binary), partitions (int32) and offsets (int64) of some messages."""


def decode_json(values: Any, partitions: Any, offsets: Any) -> Changes:
    """One change per message."""
    texts: list[bytes] = values.to_pylist()
    partition = partitions.to_numpy(zero_copy_only=False)
    unreadable, first = 0, ""
    try:
        messages = _all.decode(b"[" + b",".join(texts) + b"]")
        whole = len(messages) == len(texts)
    except (msgspec.DecodeError, TypeError):
        whole = False
    if not whole:
        kept, messages = [], []
        for row, text in enumerate(texts):
            message, reason = _read(text)
            if message is None:
                unreadable += 1
                first = first or _where(partitions, offsets, row, reason)
                continue
            kept.append(row)
            messages.append(message)
        partition = partition[kept]
    for message in messages:
        if message.gap is not None:
            message.signal, message.value = GAP, read_time(message.gap) or 0
    time_ns, known = _times([message.time for message in messages])
    plant = names([message.plant or "" for message in messages])
    changes = Changes(
        time_ns,
        names([message.signal or None for message in messages]),
        np.fromiter((message.value for message in messages), np.int64, len(messages)),
        plant,
        partition,
        offsets[0].as_py() if len(offsets) else 0,
        unreadable,
        first,
    )
    if known.all():
        return changes
    row = int(np.flatnonzero(~known)[0])
    reason = f"has no time that can be read: {messages[row].time!r}"
    return changes.only(known).blaming(int((~known).sum()), reason)


def decode_binary(values: Any, partitions: Any, offsets: Any) -> Changes:
    """One change per message."""
    texts: list[bytes] = values.to_pylist()
    partition = partitions.to_numpy(zero_copy_only=False)
    long_enough = np.array([text is not None and len(text) >= FIXED for text in texts], bool)
    first = ""
    if not long_enough.all():
        row = int(np.flatnonzero(~long_enough)[0])
        reason = f"has {len(texts[row] or b'')} bytes, not {FIXED} or more"
        first = _where(partitions, offsets, row, reason)
        texts = [texts[row] for row in np.flatnonzero(long_enough)]
        partition = partition[long_enough]
    fixed = np.frombuffer(b"".join([text[:FIXED] for text in texts]), "<i8").reshape(-1, 2)
    signals, bad_name = _names([text[FIXED:] or None for text in texts])
    changes = Changes(
        fixed[:, 0],
        signals,
        fixed[:, 1],
        everywhere("", len(fixed)),
        partition,
        offsets[0].as_py() if len(offsets) else 0,
        int((~long_enough).sum()),
        first,
    )
    if bad_name is None:
        return changes
    return changes.only(~bad_name).blaming(int(bad_name.sum()), "has a name that is not UTF-8")


def decode_arrow(values: Any, partitions: Any, offsets: Any) -> Changes:
    """Many changes per message."""
    tables, counts, kept = [], [], []
    unreadable, first = 0, ""
    for row, message in enumerate(values):
        try:
            table = pa.ipc.open_stream(message.as_buffer()).read_all()
            tables.append(_plain(table))
        except (pa.ArrowException, KeyError, TypeError, AttributeError) as error:
            unreadable += 1
            first = first or _where(partitions, offsets, row, f"is no Arrow stream: {error}")
            continue
        counts.append(len(table))
        kept.append(row)
    table = pa.concat_tables(tables) if tables else _PLAIN.empty_table()
    partition = partitions.to_numpy(zero_copy_only=False)[kept]
    return Changes(
        table.column("time").to_numpy(),
        names(_array(table.column("signal"))),
        table.column("value").to_numpy(),
        names(_array(table.column("plant"))),
        np.repeat(partition, counts) if counts else partition,
        offsets[0].as_py() if len(offsets) else 0,
        unreadable,
        first,
    )


FORMATS: dict[str, Decoder] = {
    "json": decode_json,
    "binary": decode_binary,
    "arrow": decode_arrow,
}


_PLAIN = pa.schema(
    [("time", pa.int64()), ("signal", pa.string()), ("value", pa.int64()), ("plant", pa.string())]
)


def _plain(table: pa.Table) -> pa.Table:
    time = table.column("time")
    if pa.types.is_timestamp(time.type):
        time = time.cast(pa.timestamp("ns", time.type.tz)).cast(pa.int64())
    plant = (
        pc.fill_null(table.column("plant").cast(pa.string()), "")
        if "plant" in table.column_names
        else pa.array([""] * len(table), pa.string())
    )
    signal = table.column("signal").cast(pa.string())
    value = table.column("value").cast(pa.int64())
    if time.null_count or value.null_count:
        raise TypeError("a time or a value is missing")
    return pa.Table.from_arrays([time, signal, value, plant], schema=_PLAIN)


def _array(column: Any) -> Any:
    combined = column.combine_chunks()
    return combined if isinstance(combined, pa.Array) else combined.chunk(0)


def _names(texts: list[bytes | None]) -> tuple[Any, Any]:
    encoded = pa.array(texts, pa.binary())
    try:
        return names(encoded.cast(pa.string())), None
    except pa.ArrowInvalid:
        decoded = [None if text is None else _utf8(text) for text in texts]
        bad = [text is not None and name is None for text, name in zip(texts, decoded, strict=True)]
        return names(decoded), np.array(bad)


def _utf8(text: bytes) -> str | None:
    try:
        return text.decode()
    except UnicodeDecodeError:
        return None


def _read(text: bytes | None) -> tuple[_Message | None, str]:
    if text is None:
        return None, "is empty"
    try:
        return _one.decode(text), ""
    except msgspec.DecodeError as error:
        reason = str(error)
    # Values as an MQTT message may write them: "ON", "off", "1".
    try:
        content = msgspec.json.decode(text)
        [member] = read_payload(msgspec.json.encode({"value": content["value"]}))
        if member.value is None:
            return None, f"{member.reason}"
        content["value"] = member.value
        return msgspec.convert(content, _Message), ""
    except (msgspec.DecodeError, KeyError, TypeError, ValueError):
        return None, f"is no change: {reason}"


def _times(times: Sequence[str | int | float]) -> tuple[Any, Any]:
    every = np.ones(len(times), bool)
    if all(isinstance(time, str) for time in times):
        try:
            stamps = pa.array(times, pa.string()).cast(pa.timestamp("ns", "UTC"))
            return stamps.cast(pa.int64()).to_numpy(zero_copy_only=False), every
        except pa.ArrowInvalid:
            pass
    elif all(isinstance(time, int) for time in times):
        stamps = np.array(times)
        # Nanoseconds, all of them: the rule by size would say so, one by one.
        if stamps.dtype == np.int64 and len(stamps) and stamps.min() >= 10**17:
            return stamps, every
    read = [read_time(time) for time in times]
    known = np.array([time is not None for time in read], bool)
    return np.array([time or 0 for time in read], np.int64), known


def _where(partitions: Any, offsets: Any, row: int, reason: str) -> str:
    return f"(partition {partitions[row]}, offset {offsets[row]}) {reason}"
