"""What was found goes back: an address and its name, written into the symbol table."""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING

from runglight import _engine
from runglight.errors import InputError
from runglight.log.symbols import read_symbols
from runglight.nearest import suggestion
from runglight.replacing import replacing

if TYPE_CHECKING:
    from pathlib import Path

    from runglight.identification.subject import Subject

COLUMNS = ("address", "group", "device", "signal", "class", "type", "description")


def found_in(subject: Subject, address: str, where: str) -> tuple[str, int | None]:
    """The signal an address is, and the bit of it; InputError where the log has no such address."""
    found = subject.log.engine.find_address(address)
    if found is None:
        near = suggestion(address, subject.log.signals)
        raise InputError(f"{where}: the log has no address {address!r}{near}")
    return found


def type_in(subject: Subject, signal: str, bit: int | None) -> str:
    """The type of what `found_in` found: as the recording says, else by the values."""
    if bit is not None:
        return "BOOL"
    if signal in subject.types:
        return subject.types[signal]
    _, signals, values = subject.log.columns()
    of_signal = values[signals == subject.log.signals.index(signal)]
    return "INT" if ((of_signal < 0) | (of_signal > 1)).any() else "BOOL"


def accept(  # noqa: PLR0917
    table: Path, address: str, name: str, naming: str, type: str = "", where: str = "--name"
) -> str | None:
    """Calls an address by a name in a symbol table, which is made where there is none.

    All other rows stay as they are, and so do the other columns of the row. Returns the name the
    address had before. InputError where the name does not fit the naming rule or belongs to
    another address; nothing is written then.
    """
    split = _engine.split_name(naming, name)
    if split is None:
        raise InputError(f"{where}: {name!r} does not fit the naming rule {naming}")
    parts = dict(zip(("group", "device", "signal"), split, strict=True))
    text = read_symbols(table) if table.exists() else ",".join(COLUMNS) + "\n"
    delimiter = next((known for known in ";\t," if known in text.partition("\n")[0]), ",")
    header, *rows = [row for row in csv.reader(io.StringIO(text), delimiter=delimiter) if row]
    places = {column.strip().casefold(): at for at, column in enumerate(header)}
    for column in COLUMNS[1:4]:
        if column not in places:
            places[column] = len(header)
            header.append(column)
    rows = [row + [""] * (len(header) - len(row)) for row in rows]

    def cell(row: list[str], column: str) -> str:
        return row[places[column]].strip()

    def name_of(row: list[str]) -> str:
        return "-".join(filter(None, (cell(row, column) for column in COLUMNS[1:4])))

    wanted = "-".join(parts.values())
    other = next(
        (
            cell(row, "address")
            for row in rows
            if name_of(row) == wanted and cell(row, "address") != address
        ),
        None,
    )
    if other is not None:
        raise InputError(f"{table}: {name} is the name of {other} already; choose another name")
    known = next((row for row in rows if cell(row, "address") == address), None)
    before = None if known is None else name_of(known) or None
    if known is None:
        known = [""] * len(header)
        known[places["address"]] = address
        if "type" in places:
            known[places["type"]] = type
        rows.append(known)
    for column, part in parts.items():
        known[places[column]] = part
    _write(table, [header, *rows], delimiter)
    return before


def _write(table: Path, rows: list[list[str]], delimiter: str) -> None:
    with replacing(table) as temporary, temporary.open("w", encoding="utf-8", newline="") as to:
        csv.writer(to, delimiter=delimiter, lineterminator="\n").writerows(rows)
