"""When a camera says it took a JPEG: EXIF DateTimeOriginal (Exif 2.32, 4.6.5 and 4.6.6)."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from datetime import datetime

_EXIF_POINTER = 0x8769
_DATE_TIME_ORIGINAL = 0x9003
_OFFSET_TIME_ORIGINAL = 0x9011
_SUB_SECONDS_ORIGINAL = 0x9291
_APP1 = 0xE1
_START_OF_SCAN = 0xDA


def taken_ns(content: bytes) -> int | None:
    """Nanoseconds since 1970; None where the file does not tell.

    A camera that does not write its offset from UTC has the time zone of this computer.
    """
    try:
        tiff = _tiff(content)
        if tiff is None:
            return None
        order = {b"II": "<", b"MM": ">"}[tiff[:2]]
        entries = dict(_entries(tiff, order, struct.unpack_from(f"{order}I", tiff, 4)[0]))
        if _EXIF_POINTER not in entries:
            return None
        within = dict(_entries(tiff, order, struct.unpack(f"{order}I", entries[_EXIF_POINTER])[0]))
        return _moment(
            _text(within.get(_DATE_TIME_ORIGINAL)),
            _text(within.get(_SUB_SECONDS_ORIGINAL)),
            _text(within.get(_OFFSET_TIME_ORIGINAL)),
        )
    except (struct.error, KeyError, ValueError, OverflowError, OSError):
        # Bytes that are no EXIF after all tell no time.
        return None


def _moment(text: str, fraction: str, offset: str) -> int | None:
    if not text:
        return None
    moment = datetime.strptime(text + offset, "%Y:%m:%d %H:%M:%S" + ("%z" if offset else ""))
    digits = fraction if fraction.isdecimal() else "0"
    return int(moment.timestamp()) * 1_000_000_000 + int(digits[:9].ljust(9, "0"))


def _tiff(content: bytes) -> bytes | None:
    """The TIFF structure in the APP1 segment of a JPEG."""
    if content[:2] != b"\xff\xd8":
        return None
    at = 2
    while at + 4 <= len(content) and content[at] == 0xFF and content[at + 1] != _START_OF_SCAN:
        length = struct.unpack_from(">H", content, at + 2)[0]
        segment = content[at + 4 : at + 2 + length]
        if content[at + 1] == _APP1 and segment[:6] == b"Exif\0\0":
            return segment[6:]
        at += 2 + length
    return None


def _entries(tiff: bytes, order: str, at: int) -> Iterator[tuple[int, bytes]]:
    """Tag and bytes of each entry that is text (2) or one long (4)."""
    (count,) = struct.unpack_from(f"{order}H", tiff, at)
    for entry in range(at + 2, at + 2 + 12 * count, 12):
        tag, kind, size = struct.unpack_from(f"{order}HHI", tiff, entry)
        if kind == 4 and size == 1:
            yield tag, tiff[entry + 8 : entry + 12]
        elif kind == 2 and size <= 4:
            yield tag, tiff[entry + 8 : entry + 8 + size]
        elif kind == 2:
            (place,) = struct.unpack_from(f"{order}I", tiff, entry + 8)
            yield tag, tiff[place : place + size]


def _text(content: bytes | None) -> str:
    return (content or b"").partition(b"\0")[0].decode("ascii", "replace").strip()
