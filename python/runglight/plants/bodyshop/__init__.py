"""A body shop of the sizes of Ghosh 2016: thousands of devices that wait for one another."""

from runglight.plants.bodyshop.simulate import BodyshopRun, Part, simulate_bodyshop, simulate_part
from runglight.plants.bodyshop.sizes import SIZES, Size
from runglight.plants.bodyshop.truth import TransitionTimes, Trigger

__all__ = [
    "SIZES",
    "BodyshopRun",
    "Part",
    "Size",
    "TransitionTimes",
    "Trigger",
    "simulate_bodyshop",
    "simulate_part",
]
