"""How much of what is put into a log, and where it may go."""

from dataclasses import dataclass

from runglight.errors import InputError
from runglight.injection.distribution import Distribution
from runglight.injection.kinds import SEQUENCE_KINDS, InjectionKind

ONE_TO_TWO_AND_A_HALF_S = Distribution("normal", 1.0, 2.5)
"""Ghosh 2016, Table 5."""
FOUR_MINUTES = Distribution("constant", 240.0, 240.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class InjectionPlan:
    """What to inject. The defaults inject nothing; the same plan and log give the same result."""

    faults: int = 0
    """Faults of order, spread over `kinds`."""
    kinds: tuple[InjectionKind, ...] = SEQUENCE_KINDS
    """Kinds that `faults` is spread over."""
    late: int = 0
    """Transitions that take longer than ever."""
    late_over: Distribution = ONE_TO_TWO_AND_A_HALF_S
    """Seconds over the true maximum of the transition."""
    early: int = 0
    """Transitions that take less time than ever."""
    early_under: Distribution = ONE_TO_TWO_AND_A_HALF_S
    """Seconds under the true minimum of the transition."""
    stalls: int = 0
    """Silences of a group."""
    stall_over: Distribution = FOUR_MINUTES
    """Seconds over the longest silence of the group."""
    branch_shifts: int = 0
    """Periods in which a device takes its branches in other shares."""
    time_shifts: int = 0
    """Periods in which a transition takes its several times in other shares."""
    shift_passes: int = 100
    """Passes of the branch or transition in such a period."""
    shift_by: float = 0.4
    """By how much the share is to change; a quarter less is accepted."""
    stuck_cycles: tuple[int, int] = (1, 3)
    """Least and most switching cycles of the signal that a stuck signal leaves out."""
    stuck_for: Distribution | None = None
    """How long a signal is stuck, instead of `stuck_cycles`; whole cycles are left out."""
    seed: int = 1
    """The same seed gives the same faults."""
    after: float = 0.1
    """Share of the log's time that is left clean at its start."""
    from_ns: int | None = None
    """Time before which the log is left clean, instead of `after`."""
    spacing_s: float = 10.0
    """Least time between two faults of one group."""
    longest_s: float = 60.0
    """Transitions that ever took longer are waits; they are made neither late nor early."""
    minimum_passes: int = 5
    """Transitions seen less often have no true maximum or minimum."""

    def __post_init__(self) -> None:
        for name in ("faults", "late", "early", "stalls", "branch_shifts", "time_shifts"):
            if getattr(self, name) < 0:
                raise InputError(f"{name.replace('_', ' ')}: {getattr(self, name)} is below zero")
        if not 0 <= self.after < 1:
            raise InputError(f"after: {self.after:g} is no share of the log from 0 to below 1")
        if not self.spacing_s >= 0:
            raise InputError(f"spacing: {self.spacing_s:g} s is below zero")
        for kind in self.kinds:
            if kind not in SEQUENCE_KINDS:
                raise InputError(
                    f"kinds: {kind} has its own number; "
                    f"faults are spread over {', '.join(SEQUENCE_KINDS)}"
                )
        if self.faults and not self.kinds:
            raise InputError(f"kinds: none given; there are {', '.join(SEQUENCE_KINDS)}")
        least, most = self.stuck_cycles
        if not 1 <= least <= most:
            raise InputError(f"stuck cycles: {least}:{most} must be LEAST:MOST, from 1")
        if not 0 < self.shift_by <= 1:
            raise InputError(f"shift by: {self.shift_by:g} is no share above 0, up to 1")
        if self.shift_passes < 1:
            raise InputError(f"shift passes: {self.shift_passes} must be at least 1")
