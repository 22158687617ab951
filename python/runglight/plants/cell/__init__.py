"""The cell of Ghosh 2016, Figure 2: part loader, robot 1, Daecha, its clamp and robot 2."""

from runglight.plants.cell.controller import CellController
from runglight.plants.cell.faults import FAULTS
from runglight.plants.cell.plant import CellPlant
from runglight.plants.cell.running import RunningCell
from runglight.plants.cell.simulate import simulate_cell
from runglight.plants.cell.symbols import INPUTS, OUTPUTS, SYMBOLS

__all__ = [
    "FAULTS",
    "INPUTS",
    "OUTPUTS",
    "SYMBOLS",
    "CellController",
    "CellPlant",
    "RunningCell",
    "simulate_cell",
]
