"""Where a soft PLC keeps its signals in an S7: process images, bit memory and data blocks."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import chain

from runglight.plants.running import Image
from runglight.plants.symbols import Symbol
from runglight.softplc.place import Area, Place, in_image_order, place_of, spelled

SMALLEST = {Area.INPUT: 128, Area.OUTPUT: 128, Area.MEMORY: 256}
"""Bytes of the areas that every S7-300 has."""

AreaKey = tuple[Area, int]
"""An area, and the number of the data block (0 elsewhere)."""

_OPTIONS = {Area.INPUT: "pe", Area.OUTPUT: "pa", Area.MEMORY: "mk"}
_SIZE_LETTERS = {8: "B", 16: "W", 32: "D"}


class S7Layout:
    """The signals of a plant in bytes; words lie with their high byte first, as in every S7."""

    def __init__(self, symbols: Sequence[Symbol]) -> None:
        self._places = [place_of(symbol) for symbol in in_image_order(symbols)]
        self.sizes: dict[AreaKey, int] = {(area, 0): size for area, size in SMALLEST.items()}
        """Bytes of every area there is."""
        for place in self._places:
            key = place.area, place.block
            self.sizes[key] = max(self.sizes.get(key, 0), _bytes(place).stop)
        self.symbols = tuple(
            replace(symbol, address=_address(place_of(symbol))) for symbol in symbols
        )
        """The plant's symbols under the addresses a tap gives them."""

    @property
    def tap_query(self) -> str:
        """The options with which a tap reads every byte that holds a signal."""
        bytes_of: dict[str, list[int]] = {}
        for place in self._places:
            option = _OPTIONS.get(place.area, f"db{place.block}")
            bytes_of.setdefault(option, []).extend(_bytes(place))
        return "&".join(f"{option}={spelled(numbers)}" for option, numbers in bytes_of.items())

    def areas(self, image: Image) -> dict[AreaKey, bytearray]:
        """Every area's bytes."""
        areas = {key: bytearray(size) for key, size in self.sizes.items()}
        for place, value in zip(self._places, chain(*image), strict=False):
            area = areas[place.area, place.block]
            if place.bits == 1:
                area[place.number] |= bool(value) << place.bit
            else:
                where = _bytes(place)
                unsigned = value & ((1 << place.bits) - 1)
                area[where.start : where.stop] = unsigned.to_bytes(len(where), "big")
        return areas


def _bytes(place: Place) -> range:
    return range(place.number, place.number + max(place.bits // 8, 1))


def _address(place: Place) -> str:
    where = f"{place.number}.{place.bit}" if place.bits == 1 else str(place.number)
    letter = _SIZE_LETTERS.get(place.bits, "")
    if place.area is Area.DATA:
        return f"DB{place.block}.DB{letter or 'X'}{where}"
    return f"{place.area}{letter}{where}"
