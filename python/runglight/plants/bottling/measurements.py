"""Measured values of the bottling machine: words that never rest, and tell of nothing."""

from math import sin, tau
from random import Random


class Measurements:
    """Written by the slow task; whole numbers, as the analog cards give them."""

    def __init__(self, seed: int) -> None:
        self._random = Random(f"{seed}/measurements")
        self.pump_pressure = 0
        self.flow = 0
        self.tank_level = 8_200
        self.temperature = 214
        self.air_pressure = 0
        self.pump_current = 0
        self.weight = 0
        self.scan_time_ms = 0

    def measure(self, time_s: float, *, fills: bool, pump: bool) -> None:
        """All of them once."""
        gauss = self._random.gauss
        self.pump_pressure = round((2_400 if pump else 300) + gauss(0, 12) - 180 * fills)
        self.flow = max(round(fills * 3_300 + gauss(0, 4)), 0)
        # The tank is filled again where it runs low.
        self.tank_level -= 3 * fills
        self.tank_level += 2_000 * (self.tank_level < 6_000)
        self.temperature = round(214 + 6 * sin(tau * time_s / 1_700) + gauss(0, 0.3))
        self.air_pressure = round(6_000 + 40 * sin(tau * time_s / 23) + gauss(0, 6))
        self.pump_current = round(870 + gauss(0, 9)) if pump else 0
        self.weight = round(4_000 + 3 * sin(tau * time_s / 90) + gauss(0, 2))
        self.scan_time_ms = round(9 + self._random.random() ** 4 * 6)
