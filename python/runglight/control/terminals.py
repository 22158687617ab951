"""Where a net's signals lie in a Modbus device, found by their names."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from runglight.errors import InputError
from runglight.taps.modbus_names import IS_BITS, Area, signal_at
from runglight.taps.ranges import spelled

MOST_BITS = 8_192
MOST_WORDS = 2_048
"""How far names are searched where the URL names no areas."""

Places = Mapping[str, tuple[Area, int]]
"""Area and number of each address."""


@dataclass(frozen=True, slots=True)
class Terminals:
    """The signals of a net in the order in which the engine takes their values."""

    names: tuple[str, ...]
    outputs: frozenset[int]
    """Which of them the controller writes."""

    @classmethod
    def of(cls, rows: Iterable[tuple[str, str]]) -> "Terminals":
        """From address and class, as the engine tells them."""
        rows = list(rows)
        outputs = frozenset(n for n, (_, kind) in enumerate(rows) if kind == "output")
        return cls(tuple(name for name, _ in rows), outputs)


def places_of(names: Iterable[str], scheme: str, where: str) -> Places:
    """Finds each address by `names=`; InputError for one that no address is called."""
    wanted = set(names)
    found: dict[str, tuple[Area, int]] = {}
    for number in range(MOST_BITS):
        if len(found) == len(wanted):
            break
        for area in Area:
            if area in IS_BITS or number < MOST_WORDS:
                name = signal_at(area, number, scheme).name
                if name in wanted:
                    found.setdefault(name, (area, number))
    missing = sorted(wanted - found.keys())
    if missing:
        raise InputError(
            f"{where}: no address is called {missing[0]} with names={scheme}; name the signals' "
            "addresses with --symbols, or write names=modbus, iec or openplc"
        )
    return found


def query_of(places: Places) -> str:
    """The options of a tap that reads these addresses and nothing else."""
    numbers: dict[Area, list[int]] = {}
    for area, number in places.values():
        numbers.setdefault(area, []).append(number)
    return "&".join(f"{area.value}={spelled(numbers[area])}" for area in Area if area in numbers)
