"""A body shop of the sizes of Ghosh 2016: thousands of devices that wait for one another."""

from runglight.plants.bodyshop.simulate import BodyshopRun, simulate_bodyshop
from runglight.plants.bodyshop.sizes import SIZES, Size
from runglight.plants.bodyshop.truth import TransitionTimes, Trigger

__all__ = [
    "SIZES",
    "BodyshopRun",
    "Size",
    "TransitionTimes",
    "Trigger",
    "simulate_bodyshop",
]
