"""Distributions as people write them: `normal:1.0:2.5`, `uniform:1:3`, `constant:2`."""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from runglight.errors import InputError

SIGMAS = 6.0
"""A normal distribution over a range has its mean in the middle and this many standard
deviations from end to end: Ghosh 2016, section 3.2, says no more than "normally distributed
within range of 1.0 to 2.5 seconds"."""

Shape = Literal["normal", "uniform", "constant"]


@dataclass(frozen=True, slots=True)
class Distribution:
    """Seconds between `least_s` and `most_s`."""

    shape: Shape
    least_s: float
    most_s: float

    def __str__(self) -> str:
        if self.shape == "constant":
            return f"constant:{self.least_s:g}"
        return f"{self.shape}:{self.least_s:g}:{self.most_s:g}"

    def draw_s(self, random: np.random.Generator, count: int) -> npt.NDArray[np.float64]:
        """So many draws; of a normal distribution, those outside the range are drawn again."""
        if self.shape != "normal" or self.least_s == self.most_s:
            return random.uniform(self.least_s, self.most_s, count)
        mean = (self.least_s + self.most_s) / 2
        deviation = (self.most_s - self.least_s) / SIGMAS
        drawn = random.normal(mean, deviation, count)
        while (outside := (drawn < self.least_s) | (drawn > self.most_s)).any():
            drawn[outside] = random.normal(mean, deviation, int(outside.sum()))
        return drawn


def distribution(text: str, name: str = "distribution") -> Distribution:
    """Reads a distribution; `name` is the option, for the error."""
    shape, *numbers = text.strip().lower().split(":")
    try:
        bounds = [float(number) for number in numbers]
    except ValueError:
        bounds = []
    if (
        not all(math.isfinite(bound) and bound > 0 for bound in bounds)
        or bounds != sorted(bounds)
        or len(bounds) != {"normal": 2, "uniform": 2, "constant": 1}.get(shape)
    ):
        raise InputError(
            f"{name}: {text!r} is no distribution of seconds above zero; "
            "write normal:LEAST:MOST, uniform:LEAST:MOST or constant:SECONDS"
        )
    return Distribution(shape, bounds[0], bounds[-1])  # type: ignore[arg-type]
