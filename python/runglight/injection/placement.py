"""Which device and group each signal of a log belongs to: what the model says."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from collections.abc import Sequence

# The engine's order inside one scan: inputs are read before outputs are written.
_SCAN_RANK = {"input": 0, "memory": 1, "output": 2}


@dataclass(frozen=True, slots=True)
class Placement:
    """Devices and groups by number; signals by their number in `symbols`."""

    symbols: tuple[str, ...]
    names: tuple[str, ...]
    """Full names, `Group1-Device2-Signal2`."""
    word: npt.NDArray[np.bool_]
    """Per signal: an integer rather than ON and OFF."""
    rank: npt.NDArray[np.int64]
    """Per signal: its place among the events of one scan."""
    device_of: npt.NDArray[np.int64]
    """Per signal."""
    devices: tuple[str, ...]
    group_of: npt.NDArray[np.int64]
    """Per device."""
    groups: tuple[str, ...]

    def state_name(self, signal: int, value: int) -> str:
        """`Group1-Device2-Signal2_ON`, of words `Group1-Device2-STEP=12`."""
        if self.word[signal]:
            return f"{self.names[signal]}={value}"
        return f"{self.names[signal]}_{'ON' if value else 'OFF'}"


def placement_of(symbols: Sequence[str], symbols_csv: str) -> Placement:
    """Reads the model's symbol table, whose rows are the symbols in the order of the logs."""
    rows = list(csv.DictReader(symbols_csv.splitlines()))
    devices: dict[tuple[str, str], int] = {}
    groups: dict[str, int] = {}
    for row in rows:
        groups.setdefault(row["group"], len(groups))
        devices.setdefault((row["group"], row["device"]), len(devices))
    by_class = sorted(range(len(rows)), key=lambda row: _SCAN_RANK.get(rows[row]["class"], 1))
    rank = np.empty(len(rows), dtype=np.int64)
    rank[by_class] = np.arange(len(rows))
    return Placement(
        symbols=tuple(symbols),
        names=tuple(
            f"{row['group']}-{row['device']}-{row['signal']}"
            for row, _ in zip(rows, symbols, strict=True)
        ),
        word=np.array([row["type"] != "BOOL" for row in rows], dtype=np.bool_),
        rank=rank,
        device_of=np.array([devices[row["group"], row["device"]] for row in rows], dtype=np.int64),
        devices=tuple(device for _, device in devices),
        group_of=np.array([groups[group] for group, _ in devices], dtype=np.int64),
        groups=tuple(groups),
    )
