import os
import struct
import time
from collections.abc import Iterator
from datetime import UTC, datetime

import pytest
from hypothesis import given
from hypothesis import strategies as st

from runglight.recording.exif import taken_ns

MOMENT_NS = round(datetime(2026, 1, 31, 6, 0, 12, tzinfo=UTC).timestamp()) * 10**9


def jpeg(texts: dict[int, str], order: str = "<") -> bytes:
    """A JPEG that is nothing but its EXIF, built by the standard (TIFF 6.0, Exif 2.32)."""
    mark = b"II*\0" if order == "<" else b"MM\0*"
    pointer = struct.pack(order + "HHII", 0x8769, 4, 1, 26)
    first = struct.pack(order + "H", 1) + pointer + bytes(4)
    entries, heap = b"", b""
    heap_at = 26 + 2 + 12 * len(texts) + 4
    for tag, text in sorted(texts.items()):
        content = text.encode() + b"\0"
        if len(content) <= 4:
            entries += struct.pack(order + "HHI", tag, 2, len(content)) + content.ljust(4, b"\0")
        else:
            entries += struct.pack(order + "HHII", tag, 2, len(content), heap_at + len(heap))
            heap += content
    within = struct.pack(order + "H", len(texts)) + entries + bytes(4) + heap
    tiff = mark + struct.pack(order + "I", 8) + first + within
    body = b"Exif\0\0" + tiff
    jfif = b"\xff\xe0" + struct.pack(">H", 16) + b"JFIF\0" + bytes(9)
    return b"\xff\xd8" + jfif + b"\xff\xe1" + struct.pack(">H", 2 + len(body)) + body + b"\xff\xda"


@pytest.fixture
def in_tokyo() -> Iterator[None]:
    before = os.environ.get("TZ")
    os.environ["TZ"] = "JST-9"
    time.tzset()
    yield
    if before is None:
        del os.environ["TZ"]
    else:
        os.environ["TZ"] = before
    time.tzset()


@pytest.mark.parametrize("order", ["<", ">"])
def test_the_time_with_its_offset_and_fraction(order: str) -> None:
    texts = {0x9003: "2026:01:31 07:00:12", 0x9011: "+01:00", 0x9291: "25"}
    assert taken_ns(jpeg(texts, order)) == MOMENT_NS + 250_000_000


@pytest.mark.usefixtures("in_tokyo")
def test_without_an_offset_it_is_this_computers_time() -> None:
    assert taken_ns(jpeg({0x9003: "2026:01:31 15:00:12"})) == MOMENT_NS


def test_files_that_do_not_tell() -> None:
    assert taken_ns(b"") is None
    assert taken_ns(b"\x89PNG\r\n\x1a\n" + bytes(100)) is None
    assert taken_ns(jpeg({})) is None
    assert taken_ns(jpeg({0x9003: "0000:00:00 00:00:00"})) is None
    assert taken_ns(jpeg({0x9003: "yesterday at noon"})) is None


@given(st.binary(max_size=60), st.integers(0, 150))
def test_garbled_files_raise_nothing(junk: bytes, at: int) -> None:
    whole = jpeg({0x9003: "2026:01:31 07:00:12", 0x9011: "+01:00"})
    garbled = whole[:at] + junk + whole[at + len(junk) :]
    assert taken_ns(garbled) is None or isinstance(taken_ns(garbled), int)
