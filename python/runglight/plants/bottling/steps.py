"""The active step of a sequential function chart, and since when (IEC 61131-3, 6.7)."""

from runglight.plants.agenda import nanoseconds


class Steps:
    """`step` is for the program to compare; `due_ns` is when the timer it waits for ends."""

    def __init__(self) -> None:
        self.step = 0
        self.due_ns: int | None = None
        self._since_ns = 0

    def enter(self, step: int, now_ns: int) -> None:
        """The step is active from now on."""
        self.step = step
        self.due_ns = None
        self._since_ns = now_ns

    def lasted(self, seconds: float, now_ns: int) -> bool:
        """Whether the step has been active for so long."""
        end_ns = self._since_ns + nanoseconds(seconds)
        self.due_ns = None if now_ns >= end_ns else end_ns
        return now_ns >= end_ns

    def lasted_s(self, now_ns: int) -> float:
        """How long it has been active."""
        return (now_ns - self._since_ns) / 1e9
