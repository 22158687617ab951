"""Addresses of a Schneider PLC's memory, which Modbus shows as it is: `%M0` bits, `%MW0` words."""

import re
from collections.abc import Sequence

from runglight.errors import InputError
from runglight.plants.symbols import Symbol

_BIT = re.compile(r"%M\d{1,5}")
_MEMORY = re.compile(r"%M(?P<word>W?)(?P<number>\d{1,5})")


def is_schneider(symbols: Sequence[Symbol]) -> bool:
    """Whether a plant's PLC is one: it has bits that are counted without bytes."""
    return any(_BIT.fullmatch(symbol.address) for symbol in symbols)


def schneider_number(symbol: Symbol) -> tuple[bool, int]:
    """Whether it is a word, and its number; InputError for an address that is neither."""
    match = _MEMORY.fullmatch(symbol.address)
    if match is None:
        raise InputError(
            f"{symbol.name}: {symbol.address!r} is no memory of a Schneider PLC; write %M3 or %MW3"
        )
    return bool(match["word"]), int(match["number"])
