"""The rows of a symbol table, as the page edits them."""

from __future__ import annotations

import csv
import io

import msgspec

from runglight.errors import InputError
from runglight.log.symbols import dictionaries


class Row(msgspec.Struct, rename={"signal_class": "class"}):
    """One signal."""

    address: str
    group: str = ""
    device: str = ""
    signal: str = ""
    signal_class: str = ""
    type: str = ""
    description: str = ""


COLUMNS = ("address", "group", "device", "signal", "class", "type", "description")


def parse_rows(text: str) -> list[Row]:
    """The rows of a `symbols.csv`; columns of its own are left out."""
    return [
        msgspec.convert({key: cells.get(key, "") for key in COLUMNS}, Row)
        for cells in dictionaries(text)
    ]


def rows_text(rows: list[Row]) -> str:
    """The table as a file; InputError for an address without text, and for one that is twice."""
    seen: dict[str, int] = {}
    names: dict[tuple[str, str, str], int] = {}
    for number, row in enumerate(rows, 1):
        address = row.address.strip()
        if not address:
            raise InputError(f"row {number}: has no address; write one, or take the row away")
        if address in seen:
            raise InputError(f"row {number}: {address} is in row {seen[address]} already")
        seen[address] = number
        name = (row.group.strip(), row.device.strip(), row.signal.strip())
        if name[2] and name in names:
            raise InputError(
                f"row {number}: {'-'.join(part for part in name if part)} is the name of row "
                f"{names[name]} already"
            )
        names[name] = number
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for row in rows:
        cells = msgspec.to_builtins(row)
        writer.writerow([str(cells[key]).strip() for key in COLUMNS])
    return text.getvalue()
