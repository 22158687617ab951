"""Which program controls which plant (Theis 2019, section VI-C)."""

from dataclasses import dataclass

from runglight.plants.tank.flows import P1, P2, Flows
from runglight.plants.tank.ladder import Ladder
from runglight.plants.tank.programs import C1, C2


@dataclass(frozen=True, slots=True)
class Scenario:
    """A program and a plant."""

    program: Ladder
    flows: Flows


SCENARIOS = {"1": Scenario(C1, P1), "2": Scenario(C2, P1), "3": Scenario(C2, P2)}
