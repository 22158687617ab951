"""The bottle filling machine of Cadiou 2019, section 4: a black box with 400 addresses."""

from runglight.plants.bottling.running import RunningBottling
from runglight.plants.bottling.scene import Happening, Scene, Sight
from runglight.plants.bottling.simulate import simulate_bottling
from runglight.plants.bottling.symbols import SYMBOLS
from runglight.plants.bottling.truth import CONVEYOR, MEANINGS, PARTS, Meaning

__all__ = [
    "CONVEYOR",
    "MEANINGS",
    "PARTS",
    "SYMBOLS",
    "Happening",
    "Meaning",
    "RunningBottling",
    "Scene",
    "Sight",
    "simulate_bottling",
]
