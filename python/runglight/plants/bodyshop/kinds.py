"""The equipment of a body shop: what each kind of device does in one cycle.

Every kind starts with a short stroke: the signal that starts it has gone on and off before the next
device of the line starts, so the order of the devices' first signals is the order of the line.
"""

from dataclasses import dataclass
from functools import lru_cache

from runglight.plants.bodyshop.steps import Cycle, read_cycle


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of device: how its cycle starts, what it repeats (`#` is the number) and how it ends.

    The `units` are repeated in turn; each has the same number of signals. `share` is the kind's
    share of the devices that follow the first of their cell.
    """

    name: str
    sentence: str
    share: float
    start: str
    units: tuple[str, ...]
    end: str
    close_times: bool = False
    """Its times for different parts lie less than 1 s apart."""

    @property
    def fewest_signals(self) -> int:
        """Signals of a device with one unit."""
        return len(self._cycle(1, 0).signals)

    def cycle(self, signals: int) -> Cycle:
        """The cycle of a device with so many signals; what fills no unit are part sensors."""
        none, one = (len(self._cycle(units, 0).signals) for units in (0, 1))
        return self._cycle(*divmod(signals - none, one - none))

    def _cycle(self, units: int, sensors: int) -> Cycle:
        return _cycle(self, units, sensors)


@lru_cache(maxsize=1024)
def _cycle(kind: Kind, units: int, sensors: int) -> Cycle:
    repeated = [
        kind.units[number % len(kind.units)].replace("#", str(number + 1))
        for number in range(units)
    ]
    checks = [f"PartChk{number + 1}+m PartChk{number + 1}-m" for number in range(sensors)]
    return read_cycle(" ".join([kind.start, *repeated, *checks, kind.end]))


CONVEYOR = Kind(
    "Conveyor",
    "brings the parts of a cell",
    0.0,
    "PartIn+w MOTOR+c PartIn-m",
    (
        "RUN#+p Zone#+m RUN#-c Zone#-f",
        "RUN#+w Zone#+m RUN#-c Zone#-p",
        "RUN#+p Zone#+m RUN#-c Zone#-p",
    ),
    "PartOut+m MOTOR-c PartOut-p",
)

FOLLOWERS = (
    Kind(
        "Clamp",
        "holds the parts while they are joined",
        0.25,
        "CLOSE+w {OpSen1-l OpSen2-l} ClsSen1+m ClsSen2+l CLOSE-c",
        (
            "GRIP#+w GripOp#-l GripCls#+m GRIP#-p GripCls#-l GripOp#+m",
            "GRIP#+p GripOp#-l GripCls#+m GRIP#-w GripCls#-l GripOp#+m",
        ),
        "OPEN+w ClsSen1-l ClsSen2-l OpSen1+m OpSen2+l OPEN-c",
    ),
    Kind(
        "Robot",
        "handles and joins parts, and measures the result",
        0.25,
        "START+w HomePos-l Running+l START-c",
        (
            "JOB#+w WorkComp#+p JOB#-c WorkComp#-p",
            "JOB#+p WorkComp#+p JOB#-c WorkComp#-p",
        ),
        "MEASURE+p 0.9<ResultOk+m ResultOk-m|ResultNok+m ResultNok-t> MEASURE-c "
        "RETURN+c HomePos+m Running-l RETURN-c",
    ),
    Kind(
        "WeldGun",
        "welds seams; its coolant is watched",
        0.16,
        "ADVANCE+w RetSen-l AdvSen+m ADVANCE-c Coolant+m Overheat+l Overheat-l",
        (
            "WELD#+w Welded#+p WELD#-c Welded#-p",
            "WELD#+p Welded#+p WELD#-c Welded#-p",
        ),
        "TIP_DRESS+m [Coolant-m Overheat+m Overheat-t Coolant+m] TIP_DRESS-m "
        "RETRACT+p AdvSen-l RetSen+m RETRACT-c Coolant-m",
    ),
    Kind(
        "Stacker",
        "takes the right part from its place in the store",
        0.07,
        "RELEASE+w HomePos-l RELEASE-c 0.5<LEFT+c LEFT-m|RIGHT+c RIGHT-m>",
        (
            "PICK#+w Picked#+m PICK#-c Picked#-p",
            "PICK#+p Picked#+m PICK#-c Picked#-p",
        ),
        "CLAMP+c Clamped+m ARM+c ArmOut+m ARM-p ArmOut-m CLAMP-c Clamped-m HomePos+m",
        close_times=True,
    ),
    Kind(
        "Shuttle",
        "carries parts from one place to the next",
        0.09,
        "FORWARD+w RetSen-l AdvSen+m FORWARD-c",
        (
            "STOP#+w Stopped#+m STOP#-p Stopped#-p",
            "STOP#+p Stopped#+m STOP#-w Stopped#-p",
        ),
        "BACKWARD+w AdvSen-l RetSen+m BACKWARD-c",
    ),
    Kind(
        "PrtLdr",
        "is loaded by hand and takes the parts to the robot",
        0.08,
        "FORWARD+w RetSen-l AdvSen+m FORWARD-c",
        (
            "LIFT#+w Lifted#+m LIFT#-p Lifted#-p",
            "LIFT#+p Lifted#+m LIFT#-p Lifted#-m",
        ),
        "Loaded1-m Loaded2-l BACKWARD+w AdvSen-l RetSen+m BACKWARD-c Loaded1+f Loaded2+m",
    ),
    Kind(
        "Turntable",
        "turns the fixture to the other side and back",
        0.05,
        "TURN+w PosA-l PosB+m TURN-c LOCK+c {Locked1+m Locked2+l}",
        (
            "FIX#+w Fixed#+m FIX#-p Fixed#-p",
            "FIX#+p Fixed#+m FIX#-w Fixed#-m",
        ),
        "LOCK-w Locked1-l Locked2-l BACK+c PosB-l PosA+m BACK-c",
    ),
    Kind(
        "Sealer",
        "lays beads of sealant",
        0.05,
        "PURGE+w Purged+m PURGE-c Purged-l",
        (
            "BEAD#+w Sealed#+p BEAD#-c Sealed#-p",
            "BEAD#+p Sealed#+p BEAD#-c Sealed#-p",
        ),
        "CLEAN+w Cleaned+m CLEAN-c Cleaned-l",
    ),
)
