"""How long steps take: from one PLC scan to minutes, by part type, each within firm bounds.

All times in milliseconds.
"""

from collections.abc import Callable
from random import Random

from runglight.plants.bodyshop.plan import Times
from runglight.plants.bodyshop.sizes import MINUTE_MS, Size
from runglight.plants.bodyshop.steps import Step

SEVERAL_TIMES_SHARE = 0.33
SEVERAL_CLOSE_TIMES_SHARE = 0.8
PROGRAM_SHARE = (0.75, 1.05)
"""A program's or a wait's part of what is left of the takt for each of them."""

Bounds = tuple[Times, Times]
"""Least and most, by part type."""


class Durations:
    """Draws the bounds of steps."""

    def __init__(self, size: Size, random: Random) -> None:
        self._random = random
        self._types = size.types
        self._haste = max(size.shortest_takt_ms / (60 * MINUTE_MS), 0.3)

    def of(self, step: Step, close_times: bool) -> Bounds:  # noqa: PLR0911 - one per pace
        """Bounds of a step; a program's are zero until it is known what is left for it."""
        draw = self._random.uniform
        match step.pace:
            case "c":
                return self._between(draw(20, 40), draw(20, 40))
            case "l":
                return self._between(draw(60, 400), draw(20, 50))
            case "m":
                return self._motion(draw(800, 9_000), draw(0.005, 0.02), close_times)
            case "t":
                return self._around([draw(15_000, 30_000) * self._haste] * self._types, 0.02)
            case "f":
                least, width = draw(10_000, 40_000), draw(30_000, 90_000)
                return self._between(least * self._haste, width * self._haste)
            case "w":
                return self._between(draw(10, 30), draw(20, 50))
            case "p":
                return self._between(0, 0)

    def program(self, share_ms: float) -> Bounds:
        """Bounds of a program: a timer is exact, a robot as exact as its motions."""
        draw = self._random.uniform
        middles = [max(share_ms * draw(*PROGRAM_SHARE), 500.0)] * self._types
        if self._random.random() < SEVERAL_TIMES_SHARE:
            self._set_apart(middles, lambda at: at * draw(1.08, 1.16))
        return self._around(middles, draw(0.001, 0.005) if self._random.random() < 0.4 else 0.0)

    def _motion(self, middle: float, jitter: float, close_times: bool) -> Bounds:
        draw = self._random.uniform
        middles = [middle] * self._types
        if close_times and self._random.random() < SEVERAL_CLOSE_TIMES_SHARE:
            self._set_apart(middles, lambda at: at + draw(350, 800))
        elif not close_times and self._random.random() < SEVERAL_TIMES_SHARE:
            self._set_apart(middles, lambda at: at + draw(1_200, 4_000))
        return self._around(middles, jitter)

    def _set_apart(self, middles: list[float], next_one: Callable[[float], float]) -> None:
        """At least two of the times become different ones."""
        for kind in range(1, len(middles)):
            again = kind > 1 and self._random.random() < 0.5
            middles[kind] = middles[kind - 1] if again else next_one(middles[kind - 1])
        self._random.shuffle(middles)

    def _between(self, least: float, width: float) -> Bounds:
        return (round(least),) * self._types, (round(least + width),) * self._types

    def _around(self, middles: list[float], jitter: float) -> Bounds:
        widths = [max(at * jitter, 15.0) for at in middles]
        return (
            tuple(round(at - width) for at, width in zip(middles, widths, strict=True)),
            tuple(round(at + width) for at, width in zip(middles, widths, strict=True)),
        )
