"""The tank of Theis 2019: three level sensors, two valves, and programs to be mined."""

from runglight.plants.tank.faults import FAULTS
from runglight.plants.tank.programs import PROGRAMS
from runglight.plants.tank.running import RunningTank, run_tank
from runglight.plants.tank.scenarios import SCENARIOS, Scenario
from runglight.plants.tank.simulate import simulate_tank
from runglight.plants.tank.symbols import INPUTS, OUTPUTS, SYMBOLS

__all__ = [
    "FAULTS",
    "INPUTS",
    "OUTPUTS",
    "PROGRAMS",
    "SCENARIOS",
    "SYMBOLS",
    "RunningTank",
    "Scenario",
    "run_tank",
    "simulate_tank",
]
