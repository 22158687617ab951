"""Where a soft PLC keeps its signals in Modbus: as OpenPLC does, or as a Schneider PLC.

OpenPLC: inputs `%IX` are discrete inputs, outputs `%QX` coils, words `%IW` input registers; `%QW`
are holding registers from 0, `%MW` from 1,024 (OpenPLC, "Modbus addressing"). A plant with bits
`%M0` without a byte is a Schneider's: `%M` are coils, `%MW` holding registers, both from 0.
"""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace
from enum import StrEnum
from itertools import chain

from runglight.errors import InputError
from runglight.plants.running import Image
from runglight.plants.symbols import Symbol
from runglight.softplc.place import Area, Place, in_image_order, place_of, spelled
from runglight.softplc.schneider import is_schneider, schneider_number

BITS = 800
"""`%IX0.0` to `%IX99.7`."""
WORDS = 1024
MEMORY_FROM = 1024


class Table(StrEnum):
    """The four tables of a Modbus device, as a tap's URL calls them; inputs come first."""

    INPUTS = "inputs"
    INPUT_REGISTERS = "input_registers"
    COILS = "coils"
    HOLDING = "holding"


REGISTERS = {
    Table.INPUTS: BITS // 16,
    Table.INPUT_REGISTERS: WORDS,
    Table.COILS: BITS // 16,
    Table.HOLDING: MEMORY_FROM + WORDS,
}
"""Size of each table in words of 16 bits."""


class ModbusLayout:
    """The signals of a plant, each in its table; InputError for one that has no place in any."""

    def __init__(self, symbols: Sequence[Symbol]) -> None:
        ordered = in_image_order(symbols)
        schneider = is_schneider(symbols)
        self._names = "iec" if schneider else "openplc"
        self._cells = [_cell_of(symbol, schneider) for symbol in ordered]
        self._image: Image | None = None
        self._tables: dict[Table, list[int]] = {}
        self.symbols = (
            tuple(symbols)
            if schneider
            else tuple(
                replace(symbol, address=_address(*_cell(symbol, place_of(symbol))))
                for symbol in symbols
            )
        )
        """The plant's symbols under the addresses a tap gives them with `tap_query`."""

    @property
    def tap_query(self) -> str:
        """The options with which a tap reads every signal and nothing else."""
        numbers: dict[Table, list[int]] = defaultdict(list)
        for table, number in self._cells:
            numbers[table].append(number)
        options = [f"{table}={spelled(numbers[table])}" for table in Table if table in numbers]
        return "&".join((*options, f"names={self._names}"))

    def outputs_at(self, coils: Sequence[int]) -> list[int | None]:
        """Which of the plant's outputs each coil is; None where it is none."""
        outputs = {
            _cell(symbol, place_of(symbol)): number
            for number, symbol in enumerate(
                symbol for symbol in self.symbols if symbol.signal_class == "output"
            )
        }
        return [outputs.get((Table.COILS, coil)) for coil in coils]

    def tables(self, image: Image) -> dict[Table, list[int]]:
        """Every table as words of 16 bits, bits from the lowest on. Not to be changed."""
        if image is not self._image:
            tables = {table: [0] * size for table, size in REGISTERS.items()}
            for (table, number), value in zip(self._cells, chain(*image), strict=False):
                if table in {Table.INPUTS, Table.COILS}:
                    tables[table][number // 16] |= bool(value) << number % 16
                else:
                    tables[table][number] = value & 0xFFFF
            self._image, self._tables = image, tables
        return self._tables


def _cell_of(symbol: Symbol, schneider: bool) -> tuple[Table, int]:
    if schneider:
        is_word, number = schneider_number(symbol)
        table = Table.HOLDING if is_word else Table.COILS
        if number < (MEMORY_FROM + WORDS if is_word else BITS):
            return table, number
        raise InputError(
            f"{symbol.name}: the served PLC has no {symbol.address}; it takes %M up to {BITS - 1} "
            f"and %MW up to {MEMORY_FROM + WORDS - 1}"
        )
    return _cell(symbol, place_of(symbol))


def _cell(symbol: Symbol, place: Place) -> tuple[Table, int]:
    match place.bits, place.area:
        case 1, Area.INPUT if place.number < BITS // 8:
            return Table.INPUTS, place.number * 8 + place.bit
        case 1, Area.OUTPUT if place.number < BITS // 8:
            return Table.COILS, place.number * 8 + place.bit
        case 16, Area.INPUT if place.number < WORDS:
            return Table.INPUT_REGISTERS, place.number
        case 16, Area.OUTPUT if place.number < WORDS:
            return Table.HOLDING, place.number
        case 16, Area.MEMORY if place.number < WORDS:
            return Table.HOLDING, MEMORY_FROM + place.number
    raise InputError(
        f"{symbol.name}: Modbus has no place for {symbol.address}; it takes %IX and %QX up to "
        f"99.7, and %IW, %QW and %MW up to {WORDS - 1}; serve this plant over s7"
    )


def _address(table: Table, number: int) -> str:
    match table:
        case Table.INPUTS:
            return f"%IX{number // 8}.{number % 8}"
        case Table.COILS:
            return f"%QX{number // 8}.{number % 8}"
        case Table.INPUT_REGISTERS:
            return f"%IW{number}"
        case Table.HOLDING:
            return f"%QW{number}" if number < MEMORY_FROM else f"%MW{number - MEMORY_FROM}"
