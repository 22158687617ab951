"""How long to wait before the next attempt: to connect, to deliver."""

import random
from collections.abc import Callable

FIRST_NS = 100_000_000
LONGEST_NS = 5_000_000_000
JITTER = 0.2
"""Waits differ by up to this part, so that many taps do not fall upon a PLC at one moment."""


class Backoff:
    """Waits double from 0.1 s to 5 s (or `longest_ns`) until something succeeds."""

    def __init__(
        self, chance: Callable[[], float] = random.random, longest_ns: int = LONGEST_NS
    ) -> None:
        self._chance = chance
        self._longest_ns = longest_ns
        self._next_ns = FIRST_NS

    def wait_ns(self) -> int:
        """The next wait, in nanoseconds."""
        wait_ns = self._next_ns * (1 + JITTER * (2 * self._chance() - 1))
        self._next_ns = min(2 * self._next_ns, self._longest_ns)
        return min(round(wait_ns), self._longest_ns)

    def reset(self) -> None:
        """It worked: the next wait is the shortest again."""
        self._next_ns = FIRST_NS
