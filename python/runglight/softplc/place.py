"""Where a PLC keeps a variable: `%IX0.1`, `%MW3`, `I5.0`, `MB10`, `DB1.DBX0.0`, taken apart."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from runglight.errors import InputError
from runglight.plants.symbols import Symbol


class Area(StrEnum):
    """The parts of a PLC's memory."""

    INPUT = "I"
    OUTPUT = "Q"
    MEMORY = "M"
    DATA = "DB"


_BITS = {"X": 1, "": 1, "B": 8, "W": 16, "D": 32}
_PLAIN = re.compile(r"%?(?P<area>[IQM])(?P<size>[XBWD]?)(?P<number>\d{1,5})(?:\.(?P<bit>[0-7]))?")
_BLOCK = re.compile(
    r"%?DB(?P<block>\d{1,5})\.DB(?P<size>[XBWD])(?P<number>\d{1,5})(?:\.(?P<bit>[0-7]))?"
)


@dataclass(frozen=True, slots=True)
class Place:
    """One variable: `number` counts bytes for bits, and is otherwise the number in its address."""

    area: Area
    number: int
    bit: int = 0
    bits: int = 1
    block: int = 0
    """Of a data block; 0 elsewhere."""


def place_of(symbol: Symbol) -> Place:
    """Where a symbol lies; InputError for an address that means nothing."""
    block = _BLOCK.fullmatch(symbol.address)
    match = block or _PLAIN.fullmatch(symbol.address)
    if match is not None:
        bits = _BITS[match["size"]]
        if (bits == 1) == (match["bit"] is not None):
            return Place(
                Area.DATA if block else Area(match["area"]),
                int(match["number"]),
                int(match["bit"] or 0),
                bits,
                int(block["block"]) if block else 0,
            )
    raise InputError(
        f"{symbol.name}: {symbol.address!r} is no address of a PLC; write for example %IX0.1, "
        "%MW3, Q1.2 or DB1.DBX0.0"
    )


def in_image_order(symbols: Sequence[Symbol]) -> list[Symbol]:
    """Symbols as their values follow one another in an `Image`: inputs, outputs, memory."""
    order = ("input", "output", "memory")
    return sorted(symbols, key=lambda symbol: order.index(symbol.signal_class))


def spelled(numbers: Sequence[int]) -> str:
    """Ascending numbers as ranges: `0-7,12`."""
    runs: list[tuple[int, int]] = []
    for number in sorted(set(numbers)):
        if runs and number == runs[-1][1] + 1:
            runs[-1] = (runs[-1][0], number)
        else:
            runs.append((number, number))
    return ",".join(f"{first}-{last}" if last > first else str(first) for first, last in runs)
