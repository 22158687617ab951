"""The Sparkplug B payload: decoded from its protobuf wire format, and the one message we send.

Only what a tap needs is kept: names, aliases, times, types, and values that are boolean or integer.
Of every other value the type is kept, so that it can be said what was left out. Field numbers and
types: Sparkplug 3.0.0, 6.4 and its `sparkplug_b.proto`.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import IntEnum


class PayloadError(ValueError):
    """The bytes are no Sparkplug B payload."""


class DataType(IntEnum):
    """Types of metrics (Sparkplug 3.0.0, 6.4.16) that are booleans or integers."""

    INT8 = 1
    INT16 = 2
    INT32 = 3
    INT64 = 4
    UINT8 = 5
    UINT16 = 6
    UINT32 = 7
    UINT64 = 8
    BOOLEAN = 11


IEC_TYPES = {
    DataType.INT8: "SINT",
    DataType.INT16: "INT",
    DataType.INT32: "DINT",
    DataType.INT64: "LINT",
    DataType.UINT8: "USINT",
    DataType.UINT16: "UINT",
    DataType.UINT32: "UDINT",
    DataType.UINT64: "ULINT",
    DataType.BOOLEAN: "BOOL",
}
OTHER_TYPES = {
    0: "of no type",
    9: "a measurement (Float)",
    10: "a measurement (Double)",
    12: "text (String)",
    13: "a time (DateTime)",
    14: "text (Text)",
    15: "text (UUID)",
    16: "a DataSet",
    17: "Bytes",
    18: "a File",
    19: "a Template",
}
_SIGNED_BITS = {DataType.INT8: 8, DataType.INT16: 16, DataType.INT32: 32, DataType.INT64: 64}
_UNSIGNED_BITS = {DataType.UINT8: 8, DataType.UINT16: 16, DataType.UINT32: 32}

_VARINT, _FIXED64, _BYTES, _FIXED32 = 0, 1, 2, 5
_INT_VALUE, _LONG_VALUE, _BOOLEAN_VALUE = 10, 11, 14
_COMPRESSED = b"SPBV1.0_COMPRESSED"


@dataclass(frozen=True, slots=True)
class Metric:
    """One metric; `raw` is its boolean or integer as sent, to be read by its type."""

    name: str | None = None
    alias: int | None = None
    timestamp_ms: int | None = None
    datatype: int | None = None
    historical: bool = False
    null: bool = False
    raw: int | None = None

    def value(self, datatype: int) -> int | None:
        """The value as `datatype` reads it; None where it is no boolean or 64-bit integer."""
        if self.raw is None or self.null or datatype not in IEC_TYPES:
            return None
        if datatype == DataType.BOOLEAN:
            return int(self.raw != 0)
        signed_bits = _SIGNED_BITS.get(DataType(datatype))
        if signed_bits is not None:
            # Negative numbers travel as the two's complement in an unsigned field.
            value = self.raw & ((1 << signed_bits) - 1)
            return value - (1 << signed_bits) if value >> (signed_bits - 1) else value
        unsigned_bits = _UNSIGNED_BITS.get(DataType(datatype), 64)
        value = self.raw & ((1 << unsigned_bits) - 1)
        return value if value < 1 << 63 else None


@dataclass(frozen=True, slots=True)
class Payload:
    """One message."""

    timestamp_ms: int | None
    seq: int | None
    metrics: tuple[Metric, ...]

    def bd_seq(self) -> int | None:
        """The number that ties a death to its birth."""
        return next((metric.raw for metric in self.metrics if metric.name == "bdSeq"), None)


def decode_payload(data: bytes) -> Payload:
    """The payload in `data`; PayloadError for any bytes that are none."""
    timestamp_ms = seq = None
    metrics: list[Metric] = []
    for number, content in _fields(data):
        if number == 1:
            timestamp_ms = _integer(content)
        elif number == 2:
            metrics.append(_metric(_sequence(content)))
        elif number == 3:
            seq = _integer(content)
        elif number == 4 and content == _COMPRESSED:
            raise PayloadError("is compressed, which is not read; switch compression off")
    return Payload(timestamp_ms, seq, tuple(metrics))


def rebirth_request(now_ms: int) -> bytes:
    """NCMD `Node Control/Rebirth` = true: asks an edge node to say its birth again."""
    name = b"Node Control/Rebirth"
    metric = (
        _tag(1, _BYTES) + _varint(len(name)) + name
        + _tag(3, _VARINT) + _varint(now_ms)
        + _tag(4, _VARINT) + _varint(DataType.BOOLEAN)
        + _tag(_BOOLEAN_VALUE, _VARINT) + _varint(1)
    )  # fmt: skip
    return _tag(1, _VARINT) + _varint(now_ms) + _tag(2, _BYTES) + _varint(len(metric)) + metric


def _metric(data: bytes) -> Metric:
    name = alias = timestamp_ms = datatype = raw = None
    historical = null = False
    for number, content in _fields(data):
        match number:
            case 1:
                name = _text(content)
            case 2:
                alias = _integer(content)
            case 3:
                timestamp_ms = _integer(content)
            case 4:
                datatype = _integer(content)
            case 5:
                historical = _integer(content) != 0
            case 7:
                null = _integer(content) != 0
            case _ if number in (_INT_VALUE, _LONG_VALUE, _BOOLEAN_VALUE):
                raw = _integer(content)
    return Metric(name, alias, timestamp_ms, datatype, historical, null, raw)


def _fields(data: bytes) -> Iterator[tuple[int, int | bytes]]:
    """Field numbers and contents, as they stand; unknown fields are the caller's to skip."""
    at = 0
    while at < len(data):
        key, at = _read_varint(data, at)
        number, wire_type = key >> 3, key & 7
        content: int | bytes
        if number == 0:
            raise PayloadError("has a field without a number")
        if wire_type == _VARINT:
            content, at = _read_varint(data, at)
        else:
            if wire_type == _BYTES:
                length, at = _read_varint(data, at)
            elif wire_type in (_FIXED64, _FIXED32):
                length = 8 if wire_type == _FIXED64 else 4
            else:
                raise PayloadError(f"has a field of unknown kind {wire_type}")
            if at + length > len(data):
                raise PayloadError("ends in the middle of a field")
            content, at = data[at : at + length], at + length
        yield number, content


def _read_varint(data: bytes, at: int) -> tuple[int, int]:
    value = 0
    for shift in range(0, 70, 7):
        if at >= len(data):
            raise PayloadError("ends in the middle of a number")
        byte = data[at]
        at += 1
        value |= (byte & 0x7F) << shift
        if byte < 0x80:
            return value & 0xFFFF_FFFF_FFFF_FFFF, at
    raise PayloadError("has a number of more than ten bytes")


def _integer(content: int | bytes) -> int:
    if not isinstance(content, int):
        raise PayloadError("has bytes where a number belongs")
    return content


def _sequence(content: int | bytes) -> bytes:
    if not isinstance(content, bytes):
        raise PayloadError("has a number where bytes belong")
    return content


def _text(content: int | bytes) -> str:
    try:
        return _sequence(content).decode()
    except UnicodeDecodeError:
        raise PayloadError("has a name that is not text") from None


def _tag(number: int, wire_type: int) -> bytes:
    return _varint(number << 3 | wire_type)


def _varint(value: int) -> bytes:
    encoded = bytearray()
    while value > 0x7F:
        encoded.append(value & 0x7F | 0x80)
        value >>= 7
    encoded.append(value)
    return bytes(encoded)
