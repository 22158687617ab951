"""What is wired to the PLC of the bottling machine, over its AS-i bus."""

from enum import IntEnum, auto


class _Counted(IntEnum):
    @staticmethod
    def _generate_next_value_(_name: str, _start: int, count: int, _last: list[int]) -> int:
        return count


class Input(_Counted):
    """Sensors and buttons."""

    PART_AT_STOP = auto()
    """A bottle waits before station 1."""
    PART_ON_STATION_1 = auto()
    PART_AFTER_STATION_1 = auto()
    PART_ON_STATION_2 = auto()
    PART_AT_EXIT = auto()
    GROUP_READY = auto()
    """The rotary table holds bottles."""
    STOP_1_OPEN = auto()
    """The cylinder before station 1 is in."""
    STOP_2_OPEN = auto()
    """The cylinder after station 1 is in."""
    ARM_AT_PICK = auto()
    ARM_AT_PLACE = auto()
    CAP_GRIPPED = auto()
    CONTACTOR = auto()
    """The conveyor's contactor has pulled."""
    SELECTOR_MANUAL = auto()
    START = auto()
    JOG = auto()
    """The HMI's button that lets the conveyor run in manual."""


class Output(_Counted):
    """Motors, valves and lamps."""

    CONVEYOR = auto()
    STOP_1 = auto()
    """Opens the stop before station 1."""
    STOP_2 = auto()
    """Opens the stop after station 1."""
    STOP_3 = auto()
    """Opens the stop of station 2."""
    TABLE = auto()
    PUMP = auto()
    SHUTTER = auto()
    ARM_TO_PLACE = auto()
    ARM_TO_PICK = auto()
    GRIPPER = auto()
    SCREW = auto()
    GREEN = auto()
    ORANGE = auto()
    LABELLING = auto()
    """Follows the conveyor in automatic; no labelling machine is there."""
