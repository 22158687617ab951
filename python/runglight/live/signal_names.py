"""What the model calls a signal that a tap delivers."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from runglight.log.symbols import names_by_address, read_symbols

if TYPE_CHECKING:
    from collections.abc import Callable

    from runglight.configuration import Symbols
    from runglight.model import NominalModel
    from runglight.taps.base import TapSignal


def model_names(model: NominalModel, symbols: Symbols) -> Callable[[TapSignal], str]:
    """A function from a tap's signal to its name in the model; see `names_in_model`."""
    name_of = names_in_model(model, symbols)
    return lambda signal: name_of(signal.name, signal.address)


def names_in_model(model: NominalModel, symbols: Symbols) -> Callable[[str, str], str]:
    """A function from a signal's name and address to its name in the model.

    A signal the model knows by its own name keeps it. Otherwise its name or address is looked up
    in the symbol table of the configuration, then in the one the model was learned with: a model
    learned from addresses knows their names, and one learned from names their addresses.
    """
    known = set(model.signals)
    tables = [names_by_address(model.symbols(), symbols.naming)]
    if symbols.table is not None:
        table = read_symbols(Path(symbols.table))
        tables.insert(0, names_by_address(table, symbols.naming))
    tables += [{name: address for address, name in table.items()} for table in tables]

    def name_of(name: str, address: str) -> str:
        if name in known:
            return name
        for names in tables:
            for called in (name, address):
                if names.get(called) in known:
                    return names[called]
        return address if address in known else name

    return name_of
