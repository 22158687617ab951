"""The symbol table `symbols.csv`: which address belongs to which device, under which name."""

import csv
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path

from runglight.errors import InputError
from runglight.log.changelog import Log


def read_symbols(path: Path) -> str:
    """The text of a symbol table, checked to be text with a column `address`."""
    try:
        text = path.read_text(encoding="utf-8-sig")
        header = [name.strip().casefold() for name in next(_rows(text), [])]
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: not UTF-8 text (byte {error.start}); save it as UTF-8") from None
    except csv.Error as error:
        raise InputError(f"{path}: not a CSV table: {error}") from None
    if "address" not in header:
        raise InputError(
            f"{path}: a symbol table needs a column 'address' in its first line; "
            f"found {', '.join(header) or 'nothing'}"
        )
    return text


def _rows(text: str) -> Iterator[list[str]]:
    lines = text.splitlines()
    first = lines[0] if lines else ""
    delimiter = next((known for known in ";\t," if known in first), ",")
    return csv.reader(lines, delimiter=delimiter)


def dictionaries(symbols_csv: str) -> Iterator[dict[str, str]]:
    """The rows of a symbol table by column, in small letters; a short row lacks its last cells."""
    rows = _rows(symbols_csv)
    header = [name.strip().casefold() for name in next(rows, [])]
    for row in rows:
        # A short row lacks its last cells, which is as good as empty ones.
        yield dict(zip(header, map(str.strip, row), strict=False))


def names_by_address(symbols_csv: str, naming: str) -> dict[str, str]:
    """What the table calls each address, by the naming rule; addresses without a name are left."""
    names: dict[str, str] = {}
    for cells in dictionaries(symbols_csv):
        address, signal = cells.get("address"), cells.get("signal")
        if address and signal:
            parts = {"group": cells.get("group", ""), "device": cells.get("device", "")}
            name = naming
            for part, value in (parts | {"signal": signal}).items():
                name = name.replace("{" + part + "}", value)
            names[address] = name.strip("-")
    return names


def renamed(log: Log, names: Mapping[str, str], known: Collection[str] | None = None) -> Log:
    """The log with its addresses called by their names.

    With `known` (the signals of a model), only names the model lacks are changed, and only to
    names it has: a model learned from addresses goes on to see addresses.
    """

    def name_of(signal: str) -> str:
        name = names.get(signal, signal)
        if known is not None and (signal in known or name not in known):
            return signal
        return name

    signals = [name_of(signal) for signal in log.signals]
    if signals == log.signals:
        return log
    twice = next((name for name in signals if signals.count(name) > 1), None)
    if twice is not None:
        raise InputError(f"the symbol table gives two signals of {log.path} one name: {twice}")
    return log.renamed(signals)
