"""The plan of a whole plant: every step of every device, and what it comes after.

All times in milliseconds.
"""

from dataclasses import dataclass, field

from runglight.plants.bodyshop.layout import Device
from runglight.plants.bodyshop.sizes import Size
from runglight.plants.bodyshop.steps import Pace, Shape

ALARM_RATE = 1 / 250
"""How often a device takes its alarm path, by cycle."""

ARRIVAL_JITTER_MS = 1_500
"""How much later than planned a part arrives at most."""

Times = tuple[int, ...]
"""Milliseconds by part type."""


@dataclass(slots=True)
class Rows:
    """Every step of the plant, one row each; the rows of a device are neighbours.

    A row comes `least` to `most` after the one before it or, where a stretch begins, after the
    later of its triggers.
    """

    signal: list[int] = field(default_factory=list)
    value: list[int] = field(default_factory=list)
    pace: list[Pace] = field(default_factory=list)
    shape: list[Shape] = field(default_factory=list)
    choice: list[int] = field(default_factory=list)
    least: list[Times] = field(default_factory=list)
    most: list[Times] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class Stretch:
    """Rows `first` to before `end`, started by the later of `triggers`, or by a part."""

    first: int
    end: int
    triggers: tuple[int, ...]
    cell: int


@dataclass(frozen=True, slots=True)
class PlannedDevice:
    """A device with the place of its rows."""

    device: Device
    cell: int
    first: int
    end: int


@dataclass(slots=True)
class Plan:
    """The whole plant, ready to run. Cells are counted through all groups."""

    size: Size
    rows: Rows = field(default_factory=Rows)
    shares: list[float | None] = field(default_factory=list)
    """By choice, as in `Cycle`."""
    stretches: list[Stretch] = field(default_factory=list)
    devices: list[PlannedDevice] = field(default_factory=list)
    group_of_cell: list[int] = field(default_factory=list)
    phase_of_cell: list[int] = field(default_factory=list)
    """Milliseconds from the takt of its group."""
