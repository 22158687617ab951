"""Station 1: one bottle is let in, filled, and let go when station 2 is free."""

from collections.abc import Sequence
from enum import IntEnum

from runglight.plants.bottling.steps import Steps
from runglight.plants.bottling.terminals import Input

PASS_S = 0.15
"""A stop is open for so long that one bottle passes, and the next is still held."""

DRIP_S = 0.25


class FillingStep(IntEnum):
    """What station 1 does."""

    WAIT = 0
    LET_IN = 1
    TRAVEL = 2
    FILL = 3
    DRIP = 4
    FULL = 5
    LET_GO = 6


class FillingStation:
    """Call `scan` once per scan; the outputs are attributes."""

    def __init__(self) -> None:
        self.steps = Steps()
        self.filled = 0
        """Bottles filled since the start."""
        self.fill_s = 0.0
        """How long the last one took."""

    @property
    def lets_in(self) -> bool:
        """Opens the stop before the station."""
        return self.steps.step == FillingStep.LET_IN

    @property
    def fills(self) -> bool:
        """Opens the shutter."""
        return self.steps.step == FillingStep.FILL

    @property
    def lets_go(self) -> bool:
        """Opens the stop after the station."""
        return self.steps.step == FillingStep.LET_GO

    def scan(
        self, inputs: Sequence[bool], now_ns: int, *, running: bool, next_free: bool, fill_s: float
    ) -> None:
        """`fill_s` is how long the shutter is to be open; in manual nothing is begun."""
        steps = self.steps
        match steps.step:
            case FillingStep.WAIT if running and inputs[Input.PART_AT_STOP]:
                steps.enter(FillingStep.LET_IN, now_ns)
            case FillingStep.LET_IN if steps.lasted(PASS_S, now_ns):
                steps.enter(FillingStep.TRAVEL, now_ns)
            case FillingStep.TRAVEL if inputs[Input.PART_ON_STATION_1] and running:
                # The bottle is seen a little before it stands at the stop.
                if steps.lasted(0.1, now_ns):
                    steps.enter(FillingStep.FILL, now_ns)
            case FillingStep.FILL if steps.lasted(fill_s, now_ns):
                self.filled += 1
                self.fill_s = steps.lasted_s(now_ns)
                steps.enter(FillingStep.DRIP, now_ns)
            case FillingStep.DRIP if steps.lasted(DRIP_S, now_ns):
                steps.enter(FillingStep.FULL, now_ns)
            case FillingStep.FULL if running and next_free:
                steps.enter(FillingStep.LET_GO, now_ns)
            case FillingStep.LET_GO if inputs[Input.PART_AFTER_STATION_1]:
                steps.enter(FillingStep.WAIT, now_ns)
            case _:
                pass
