"""What a Modbus address is called: by the Modbus book, by IEC 61131-3, or as OpenPLC does."""

from dataclasses import dataclass
from enum import StrEnum

from runglight.errors import InputError
from runglight.nearest import suggestion
from runglight.taps.base import TapSignal


class Area(StrEnum):
    """The four tables of a Modbus device, in the order they are read: inputs come first."""

    INPUTS = "inputs"
    INPUT_REGISTERS = "input_registers"
    COILS = "coils"
    HOLDING = "holding"


IS_BITS = {Area.INPUTS, Area.COILS}
SINGULAR = {
    Area.INPUTS: "input",
    Area.INPUT_REGISTERS: "input register",
    Area.COILS: "coil",
    Area.HOLDING: "holding register",
}
_BOOK_PREFIX = {Area.COILS: "0", Area.INPUTS: "1", Area.INPUT_REGISTERS: "3", Area.HOLDING: "4"}
_FOUR_DIGITS = 9_999
OPENPLC_MEMORY = 1_024
"""OpenPLC keeps %MW0 at this holding register; those below are %QW."""


@dataclass(frozen=True, slots=True)
class _Named:
    name: str
    signal_class: str


def _modbus(area: Area, number: int) -> _Named:
    width = 4 if number < _FOUR_DIGITS else 5
    of_area = {Area.COILS: "output", Area.HOLDING: "memory"}
    return _Named(f"{_BOOK_PREFIX[area]}{number + 1:0{width}}", of_area.get(area, "input"))


def _iec(area: Area, number: int) -> _Named:
    """Schneider's way: coils are internal bits (Cadiou 2019)."""
    prefix, signal_class = {
        Area.COILS: ("%M", "memory"),
        Area.INPUTS: ("%I", "input"),
        Area.INPUT_REGISTERS: ("%IW", "input"),
        Area.HOLDING: ("%MW", "memory"),
    }[area]
    return _Named(f"{prefix}{number}", signal_class)


def _openplc(area: Area, number: int) -> _Named:
    byte, bit = divmod(number, 8)
    if area is Area.COILS:
        return _Named(f"%QX{byte}.{bit}", "output")
    if area is Area.INPUTS:
        return _Named(f"%IX{byte}.{bit}", "input")
    if area is Area.INPUT_REGISTERS:
        return _Named(f"%IW{number}", "input")
    if number < OPENPLC_MEMORY:
        return _Named(f"%QW{number}", "output")
    return _Named(f"%MW{number - OPENPLC_MEMORY}", "memory")


_SCHEMES = {"modbus": _modbus, "iec": _iec, "openplc": _openplc}


def check_scheme(names: str, where: str) -> None:
    """InputError unless `names` is one of modbus, iec, openplc."""
    if names not in _SCHEMES:
        near = suggestion(names, _SCHEMES) or f"; there are: {', '.join(_SCHEMES)}"
        raise InputError(f"{where}: names={names} is unknown{near}")


def signal_at(area: Area, number: int, names: str = "modbus") -> TapSignal:
    """The signal at an address, counted from 0 as on the wire."""
    named = _SCHEMES[names](area, number)
    return TapSignal(
        name=named.name,
        address=named.name,
        type="BOOL" if area in IS_BITS else "UINT",
        signal_class=named.signal_class,
        description=f"{SINGULAR[area]} {number}",
    )
