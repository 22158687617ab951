"""The time a tap lives in: the computer's, or a simulated machine's."""

import asyncio
import time
from typing import Protocol

STEP_NS = 200_000_000
"""The computer's clock has been set, not slewed, when it leaves the steady time by this much."""
SLEW = 5_000
"""The steady time follows small corrections by at most one part in this many."""


class Clock(Protocol):
    """Nanoseconds since 1970, UTC; never runs backwards."""

    def now_ns(self) -> int:
        """The time now."""

    async def sleep_until(self, time_ns: int) -> None:
        """Returns at `time_ns`; at once (after letting others run) where that has passed."""

    def take_step_ns(self) -> int | None:
        """How far the computer's clock was set since the last call; None where it was not."""


class SteadyClock:
    """The computer's time of day at the start, carried on by the monotonic clock.

    Setting the computer's clock therefore neither stretches nor doubles what is recorded: it is
    told once by `take_step_ns`. Corrections smaller than `STEP_NS` (NTP slewing, drift) are
    followed gently.
    """

    def __init__(self) -> None:
        self._offset_ns = time.time_ns() - time.monotonic_ns()
        self._ignored_ns = 0
        self._looked_ns = time.monotonic_ns()

    def now_ns(self) -> int:
        """The time now."""
        return time.monotonic_ns() + self._offset_ns

    async def sleep_until(self, time_ns: int) -> None:
        """Returns at `time_ns`, to within the event loop's resolution."""
        await asyncio.sleep(max(time_ns - self.now_ns(), 0) / 1e9)

    def take_step_ns(self) -> int | None:
        """How far the computer's clock was set since the last call; None where it was not."""
        monotonic_ns = time.monotonic_ns()
        away_ns = time.time_ns() - monotonic_ns - self._offset_ns - self._ignored_ns
        since_ns, self._looked_ns = monotonic_ns - self._looked_ns, monotonic_ns
        if abs(away_ns) >= STEP_NS:
            self._ignored_ns += away_ns
            return away_ns
        most_ns = since_ns // SLEW
        self._offset_ns += max(-most_ns, min(most_ns, away_ns))
        return None
