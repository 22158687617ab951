"""What somebody who stands before the machine sees, at one moment and as it happens."""

from dataclasses import dataclass
from enum import StrEnum


class Happening(StrEnum):
    """What can be seen to happen, without knowing anything of the PLC."""

    BOTTLE_LEAVES = "a bottle leaves station 2"
    CONVEYOR_STARTS = "the conveyor starts"
    CONVEYOR_STOPS = "the conveyor stops"


@dataclass(frozen=True, slots=True)
class Sight:
    """Something happened."""

    time_ns: int
    what: Happening


@dataclass(frozen=True, slots=True)
class BottleSight:
    """A bottle: metres from the beginning of the belt, how full (0 to 1), capped or not."""

    position_m: float
    filled: float
    capped: bool


@dataclass(frozen=True, slots=True)
class Scene:
    """The machine at one moment."""

    time_ns: int
    bottles: tuple[BottleSight, ...]
    travel_m: float
    """How far the belt has moved since the beginning: its marks move with it."""
    open_stops: frozenset[str]
    filling: bool
    arm: float
    """Of the pick-and-place: 0 over the magazine, 1 over station 2."""
    holds_cap: bool
    green: bool
    orange: bool
