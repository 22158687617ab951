"""Station 2: the pick-and-place brings a cap, screws it on, and fetches the next one."""

from collections.abc import Sequence
from enum import IntEnum

from runglight.plants.bottling.steps import Steps
from runglight.plants.bottling.terminals import Input

SCREW_S = 0.55


class CappingStep(IntEnum):
    """What station 2 does."""

    FETCH = 0
    WAIT = 1
    SWING_IN = 2
    SCREW = 3
    LET_GO = 4


class ArmStep(IntEnum):
    """What the pick-and-place does."""

    AT_MAGAZINE = 0
    TO_STATION = 1
    TO_MAGAZINE = 2


class CappingStation:
    """Call `scan` once per scan; the outputs are attributes."""

    def __init__(self) -> None:
        self.steps = Steps()
        self.grips = False
        self.capped = 0
        """Bottles capped since the start."""
        self._arm = ArmStep.AT_MAGAZINE
        self.expected = False
        """A bottle is on its way from station 1."""

    @property
    def free(self) -> bool:
        """Whether a bottle may come."""
        return not self.expected and self.steps.step in (CappingStep.FETCH, CappingStep.WAIT)

    @property
    def to_place(self) -> bool:
        """Turns the arm over the bottle."""
        return self._arm is ArmStep.TO_STATION

    @property
    def to_pick(self) -> bool:
        """Turns the arm back to the magazine."""
        return self._arm is ArmStep.TO_MAGAZINE

    @property
    def screws(self) -> bool:
        """Turns the cap."""
        return self.steps.step == CappingStep.SCREW

    @property
    def lets_go(self) -> bool:
        """Opens the stop of the station."""
        return self.steps.step == CappingStep.LET_GO

    def scan(
        self, inputs: Sequence[bool], now_ns: int, *, running: bool, screw_s: float = SCREW_S
    ) -> None:
        """In manual nothing is begun."""
        steps = self.steps
        if self._arm is ArmStep.TO_MAGAZINE and inputs[Input.ARM_AT_PICK]:
            self._arm = ArmStep.AT_MAGAZINE
        match steps.step:
            case CappingStep.FETCH if running and inputs[Input.ARM_AT_PICK]:
                self.grips = True
                if inputs[Input.CAP_GRIPPED]:
                    steps.enter(CappingStep.WAIT, now_ns)
            case CappingStep.WAIT if running and inputs[Input.PART_ON_STATION_2]:
                self.expected = False
                self._arm = ArmStep.TO_STATION
                steps.enter(CappingStep.SWING_IN, now_ns)
            case CappingStep.SWING_IN if inputs[Input.ARM_AT_PLACE]:
                steps.enter(CappingStep.SCREW, now_ns)
            case CappingStep.SCREW if steps.lasted(screw_s, now_ns):
                self.grips = False
                if running and not inputs[Input.CAP_GRIPPED]:
                    self.capped += 1
                    self._arm = ArmStep.TO_MAGAZINE
                    steps.enter(CappingStep.LET_GO, now_ns)
            case CappingStep.LET_GO if not inputs[Input.PART_ON_STATION_2]:
                steps.enter(CappingStep.FETCH, now_ns)
            case _:
                pass
