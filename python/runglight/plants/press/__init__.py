"""An S7-style press with 216 inputs, like the machine of Guim & Dias 2023."""

from runglight.plants.press.faults import FAILURES, FAULTS
from runglight.plants.press.running import RunningPress
from runglight.plants.press.simulate import simulate_press
from runglight.plants.press.symbols import INPUTS, MODES, OUTPUTS, REGIONS, SYMBOLS

__all__ = [
    "FAILURES",
    "FAULTS",
    "INPUTS",
    "MODES",
    "OUTPUTS",
    "REGIONS",
    "SYMBOLS",
    "RunningPress",
    "simulate_press",
]
