"""Addresses of signals by name, from a symbol table."""

from pathlib import Path

from runglight.errors import InputError
from runglight.log.symbols import names_by_address, read_symbols


def symbol_addresses(path: Path, naming: str) -> dict[str, str]:
    """Full name by the naming rule, to address; InputError where no row tells both."""
    names = names_by_address(read_symbols(path), naming)
    if not names:
        raise InputError(f"{path}: no row tells the name and the address of a signal")
    return {name: address for address, name in names.items()}
