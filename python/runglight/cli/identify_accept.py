"""`runglight identify --accept`: a name for an address, in the symbol table."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from rich.text import Text

from runglight.cli import terminal
from runglight.errors import InputError
from runglight.identification.accepted import accept, found_in, type_in

if TYPE_CHECKING:
    from runglight.configuration import Symbols
    from runglight.identification.subject import Subject

SYMBOLS = "symbols.csv"


def accept_address(
    subject: Subject, address: str | None, name: str | None, symbols: Symbols
) -> None:
    """Writes it, and says what to do with it; InputError where the log has no such address."""
    if address is None:
        raise InputError("--name: say with --accept which address it is the name of")
    if name is None:
        raise InputError("--accept: say with --name what the address is to be called")
    table = Path(symbols.table or SYMBOLS)
    signal, bit = found_in(subject, address, "--accept")
    before = accept(table, address, name, symbols.naming, type_in(subject, signal, bit))
    was = f" (was {before})" if before not in {None, name} else ""
    console = terminal.results()
    console.print(Text(f"{table}: {address} is {name}{was}"), soft_wrap=True)
    splitting = f" --bits {signal}" if bit is not None else ""
    console.print(
        Text(f"Next: runglight learn {subject.log.path} --symbols {table}{splitting} -o MODEL"),
        soft_wrap=True,
    )
