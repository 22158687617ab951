"""The symbol table of a simulated plant: what a PLC project would export."""

import csv
import io
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

COLUMNS = ("address", "group", "device", "signal", "class", "type", "description")

SignalClass = Literal["input", "output", "memory"]


@dataclass(frozen=True, slots=True)
class Symbol:
    """One PLC variable: its IEC 61131-3 address, its name in three parts, and what it tells."""

    address: str
    group: str
    device: str
    signal: str
    signal_class: SignalClass
    description: str
    type: str = "BOOL"

    @property
    def name(self) -> str:
        """The full name, `Group-Device-Signal`."""
        return f"{self.group}-{self.device}-{self.signal}"

    @property
    def short_name(self) -> str:
        """The name inside its group, `Device-Signal`."""
        return f"{self.device}-{self.signal}"


def bit_address(area: Literal["I", "Q"], number: int) -> str:
    """The IEC address of the given bit of an area, counted from 0: `%IX1.2` is input 10."""
    return f"%{area}X{number // 8}.{number % 8}"


def symbols_csv(symbols: tuple[Symbol, ...]) -> str:
    """The table as the text of a `symbols.csv`."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for symbol in symbols:
        writer.writerow(
            (
                symbol.address,
                symbol.group,
                symbol.device,
                symbol.signal,
                symbol.signal_class,
                symbol.type,
                symbol.description,
            )
        )
    return text.getvalue()


def write_symbols(symbols: tuple[Symbol, ...], path: Path | str) -> None:
    """Writes the table as `symbols.csv` (UTF-8)."""
    Path(path).write_text(symbols_csv(symbols), encoding="utf-8", newline="")
