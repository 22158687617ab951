"""How fast liquid moves through a valve, open or closed (Theis 2019, section VI-A)."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, slots=True)
class Flows:
    """Gallons per second: normally distributed through an open valve, uniformly through a shut one.

    A flow is never negative. It is drawn anew every second: the paper does not say how often.
    """

    name: str
    mean: float = 9.0
    deviation: float = 0.0
    leakage: float = 0.0
    """The most that a closed valve lets through."""

    @property
    def constant(self) -> bool:
        """Whether nothing is drawn."""
        return not self.deviation and not self.leakage

    def draw(self, random: np.random.Generator) -> tuple[float, float]:
        """The flow through a valve in the coming second: were it open, and were it closed."""
        if self.constant:
            return self.mean, 0.0
        open_flow = max(float(random.normal(self.mean, self.deviation)), 0.0)
        return open_flow, float(random.uniform(0.0, self.leakage))


P1 = Flows("p1")
P2 = Flows("p2", deviation=2.0, leakage=0.5)
