"""What can be done to a log."""

from enum import StrEnum


class InjectionKind(StrEnum):
    """A way in which a log departs from nominal."""

    STUCK_ON = "stuck-on"
    STUCK_OFF = "stuck-off"
    MISSING_EDGE = "missing-edge"
    SPURIOUS_PULSE = "spurious-pulse"
    SWAPPED_ORDER = "swapped-order"
    LATE = "late"
    EARLY = "early"
    STALL = "stall"
    BRANCH_SHIFT = "branch-shift"
    TIME_SHIFT = "time-shift"


SEQUENCE_KINDS = (
    InjectionKind.STUCK_ON,
    InjectionKind.STUCK_OFF,
    InjectionKind.MISSING_EDGE,
    InjectionKind.SPURIOUS_PULSE,
    InjectionKind.SWAPPED_ORDER,
)
"""Kinds that show as a transition the clean log never makes."""
