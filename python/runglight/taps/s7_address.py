"""Addresses of an S7 PLC, as people write them: `I5.0`, `E5.0`, `MW10`, `DB1.DBX0.0`."""

import re
from dataclasses import dataclass
from enum import StrEnum

from runglight.errors import InputError

MOST_BYTE = 65_535
MOST_DB = 65_535


class S7Area(StrEnum):
    """Where an S7 keeps its variables, in the order they are read: inputs come first."""

    INPUT = "I"
    OUTPUT = "Q"
    MEMORY = "M"
    DATA = "DB"


_GERMAN = {"E": "I", "A": "Q"}
_BITS_OF = {"X": 1, "": 1, "B": 8, "W": 16, "D": 32}
_SIZE_OF = {1: "X", 8: "B", 16: "W", 32: "D"}
_IN_AREA = re.compile(r"%?([IEQAM])([XBWD]?)(\d{1,5})(?:\.(\d))?", re.ASCII)
_IN_BLOCK = re.compile(r"%?DB(\d{1,5})\.DB([XBWD])(\d{1,5})(?:\.(\d))?", re.ASCII)


@dataclass(frozen=True, slots=True, order=True)
class S7Address:
    """One variable: `bits` is 1, 8, 16 or 32; `db` is 0 outside data blocks."""

    area: S7Area
    byte: int
    bit: int = 0
    bits: int = 1
    db: int = 0

    def __str__(self) -> str:
        """As S7 people write it in English: `I5.0`, `QB1`, `DB1.DBX0.0`."""
        bit = f".{self.bit}" if self.bits == 1 else ""
        size = _SIZE_OF[self.bits]
        if self.area is S7Area.DATA:
            return f"DB{self.db}.DB{size}{self.byte}{bit}"
        return f"{self.area.value}{size if self.bits > 1 else ''}{self.byte}{bit}"


def parse_s7_address(text: str) -> S7Address:
    """The variable an address means, English or German; InputError for anything else."""
    written = text.strip().upper()
    block = _IN_BLOCK.fullmatch(written)
    plain = None if block else _IN_AREA.fullmatch(written)
    if block:
        area, db = S7Area.DATA, int(block[1])
        size, byte, bit = block[2], block[3], block[4]
    elif plain:
        area, db = S7Area(_GERMAN.get(plain[1], plain[1])), 0
        size, byte, bit = plain[2], plain[3], plain[4]
    else:
        raise _refused(text)
    bits = _BITS_OF[size]
    # A bit needs its number, and only a bit has one.
    if (bits == 1) != (bit is not None) or int(bit or 0) > 7:
        raise _refused(text)
    if int(byte) + (bits - 1) // 8 > MOST_BYTE or (block and not 1 <= db <= MOST_DB):
        raise _refused(text)
    return S7Address(area, int(byte), int(bit or 0), bits, db)


def canonical_s7(text: str) -> str:
    """An address as runglight writes it (`I5.0` of `E5.0`); other text as it is."""
    try:
        return str(parse_s7_address(text))
    except InputError:
        return text


def _refused(text: str) -> InputError:
    return InputError(
        f"{text!r} is no S7 address; write for example I5.0 or E5.0, Q1.2, MB10, DB1.DBX0.0, "
        "DB1.DBW2"
    )
