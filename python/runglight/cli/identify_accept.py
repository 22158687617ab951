"""`runglight identify --accept`: a name for an address, in the symbol table."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from rich.text import Text

from runglight.cli import terminal
from runglight.errors import InputError
from runglight.identification.accepted import accept
from runglight.nearest import suggestion

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
    found = subject.log.engine.find_address(address)
    if found is None:
        near = suggestion(address, subject.log.signals)
        raise InputError(f"--accept: the log has no address {address!r}{near}")
    table = Path(symbols.table or SYMBOLS)
    signal, bit = found
    kind = "BOOL" if bit is not None else _type(subject, signal)
    before = accept(table, address, name, symbols.naming, kind)
    was = f" (was {before})" if before not in {None, name} else ""
    console = terminal.results()
    console.print(Text(f"{table}: {address} is {name}{was}"), soft_wrap=True)
    splitting = f" --bits {signal}" if bit is not None else ""
    console.print(
        Text(f"Next: runglight learn {subject.log.path} --symbols {table}{splitting} -o MODEL"),
        soft_wrap=True,
    )


def _type(subject: Subject, signal: str) -> str:
    """As the recording says; else by the values."""
    if signal in subject.types:
        return subject.types[signal]
    _, signals, values = subject.log.columns()
    of_signal = values[signals == subject.log.signals.index(signal)]
    return "INT" if ((of_signal < 0) | (of_signal > 1)).any() else "BOOL"
