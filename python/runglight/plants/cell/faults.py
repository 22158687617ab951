"""The twelve faults of Ghosh 2016, Table 4, and what sets them off.

A fault acts on a sensor or an actuator, never on the log: the log is what then happens.
"""

from dataclasses import dataclass

from runglight.plants.agenda import nanoseconds
from runglight.plants.cell.plant import CellPlant, Moment
from runglight.plants.cell.symbols import GROUP
from runglight.plants.faults import FaultDescription, FaultKind, Transition


def _state(short_state: str) -> str:
    return f"{GROUP}-{short_state}"


def _transition(text: str) -> Transition:
    before, after = text.split(" > ")
    return _state(before), _state(after)


def _describe(
    number: int,
    name: str,
    sentence: str,
    kind: FaultKind,
    where: str,
    *,
    faulty: str | None = None,
    expected: tuple[str, ...] = (),
    expected_s: float | None = None,
    last_state: str | None = None,
) -> FaultDescription:
    device, signal = where.split("-")
    return FaultDescription(
        number,
        name,
        sentence,
        kind,
        GROUP,
        device,
        signal,
        _transition(faulty) if faulty else None,
        tuple(_transition(transition) for transition in expected),
        expected_s,
        _state(last_state) if last_state else None,
    )


FAULTS: dict[int, FaultDescription] = {
    fault.number: fault
    for fault in (
        _describe(
            1,
            "prt-chk-on-while-returning",
            "The part sensor of the part loader turns on for a moment while the loader returns "
            "home empty.",
            FaultKind.SENSOR_GLITCH,
            "PrtLDR-PRT_CHK",
            faulty="PrtLDR-ADV_OFF > PrtLDR-PRT_CHK_ON",
            expected=("PrtLDR-ADV_OFF > PrtLDR-RET_ON",),
        ),
        _describe(
            2,
            "opsen1-stuck-on",
            "The sensor for the open left clamp sticks at on from the moment robot 1 picks the "
            "part up, whether the clamp is open or not.",
            FaultKind.SENSOR_STUCK_ON,
            "DCLAMP-OpSen1",
            faulty="DCLAMP-CLOSE_ON > DCLAMP-OpSen2_OFF",
            expected=("DCLAMP-CLOSE_ON > DCLAMP-OpSen1_OFF",),
        ),
        _describe(
            3,
            "open-decelerated",
            "The clamps are slow to follow their open command once.",
            FaultKind.ACTUATOR_SLOW,
            "DCLAMP-OPEN",
            faulty="DCLAMP-OPEN_ON > DCLAMP-ClsSen1_OFF",
            expected_s=0.03,
        ),
        _describe(
            4,
            "first-work-comp-off-while-moving",
            "Robot 1's report that it has picked the part up drops out for a moment while it "
            "carries the part.",
            FaultKind.SENSOR_GLITCH,
            "RBT1-1ST_WORK_COMP",
            faulty="RBT1-PRT_MOVE_ON > RBT1-1ST_WORK_COMP_OFF",
            expected=("RBT1-PRT_MOVE_ON > RBT1-2ND_WORK_COMP_ON",),
        ),
        _describe(
            5,
            "forward-dead",
            "The part loader's forward drive dies while a part is being set: the loader never "
            "leaves home and the line stops.",
            FaultKind.ACTUATOR_DEAD,
            "PrtLDR-FORWARD",
            last_state="PrtLDR-FORWARD_ON",
        ),
        _describe(
            6,
            "parts-mostly-60-s",
            "Of every thirty parts, seven come after about 30 s and twenty-three after about "
            "60 s, instead of half and half.",
            FaultKind.PART_PATTERN,
            "PrtLDR-PRT_CHK",
            faulty="PrtLDR-BACKWARD_OFF > PrtLDR-PRT_CHK_ON",
        ),
        _describe(
            7,
            "ret-off-at-home",
            "The part loader's home sensor drops out for a moment while the loader stands at "
            "home, before the first part.",
            FaultKind.SENSOR_GLITCH,
            "PrtLDR-RET",
            faulty="PrtLDR-RET_ON > PrtLDR-RET_OFF",
            expected=(
                "PrtLDR-RET_ON > PrtLDR-BACKWARD_OFF",
                "PrtLDR-RET_ON > PrtLDR-PRT_CHK_ON",
            ),
        ),
        _describe(
            8,
            "home-pos-on-while-placing",
            "Robot 1's home sensor turns on for a moment while the robot places the part on the "
            "Daecha.",
            FaultKind.SENSOR_GLITCH,
            "RBT1-HOME_POS",
            faulty="RBT1-2ND_WORK_COMP_ON > RBT1-HOME_POS_ON",
            expected=("RBT1-2ND_WORK_COMP_ON > RBT1-PRT_MOVE_OFF",),
        ),
        _describe(
            9,
            "backward-decelerated",
            "The part loader is slow to follow its backward command once.",
            FaultKind.ACTUATOR_SLOW,
            "PrtLDR-BACKWARD",
            faulty="PrtLDR-BACKWARD_ON > PrtLDR-ADV_OFF",
            expected_s=0.04,
        ),
        _describe(
            10,
            "clssen1-dead",
            "The sensor for the closed left clamp dies while the part loader advances: the "
            "clamps close, nobody hears of it, and the line stops.",
            FaultKind.SENSOR_DEAD,
            "DCLAMP-ClsSen1",
            faulty="DCLAMP-OpSen2_OFF > DCLAMP-ClsSen2_ON",
            expected=("DCLAMP-OpSen2_OFF > DCLAMP-ClsSen1_ON",),
        ),
        _describe(
            11,
            "prt-pick-dead",
            "Robot 1 stops following its pick command while the Daecha returns: in the next "
            "cycle it never starts and the line stops.",
            FaultKind.ACTUATOR_DEAD,
            "RBT1-PRT_PICK",
            last_state="RBT1-PRT_PICK_ON",
        ),
        _describe(
            12,
            "prt-move-decelerated",
            "Robot 1 carries one part to the Daecha at two thirds of its speed.",
            FaultKind.ACTUATOR_SLOW,
            "RBT1-PRT_MOVE",
            faulty="RBT1-PRT_MOVE_ON > RBT1-2ND_WORK_COMP_ON",
            expected_s=16.01,
        ),
    )
}


@dataclass(frozen=True, slots=True)
class Trigger:
    """When a fault begins, how long it lasts (None: for good), and how bad it is."""

    moment: Moment
    delay_s: float = 0.0
    lasts_s: float | None = None
    sensor_value: bool = True
    extra_response_s: float = 0.0
    slow_factor: float = 1.0


# A slow actuator recovers after its one motion; 6 needs no trigger, it is a pattern of parts.
TRIGGERS: dict[int, Trigger] = {
    1: Trigger(Moment.LOADER_RETURNING, delay_s=1.0, lasts_s=0.8),
    2: Trigger(Moment.ROBOT_1_PICKING, delay_s=1.0),
    3: Trigger(Moment.DAECHA_ADVANCING, delay_s=1.0, lasts_s=10.0, extra_response_s=2.09),
    4: Trigger(Moment.ROBOT_1_MOVING, delay_s=5.0, lasts_s=0.8, sensor_value=False),
    5: Trigger(Moment.PART_SET),
    7: Trigger(Moment.POWER_ON, delay_s=12.0, lasts_s=2.0, sensor_value=False),
    # between the report of the placed part and the program's answer, 0.1 s later
    8: Trigger(Moment.ROBOT_1_PLACED, delay_s=0.03, lasts_s=0.5),
    9: Trigger(Moment.ROBOT_1_PLACED, lasts_s=10.0, extra_response_s=2.54),
    10: Trigger(Moment.LOADER_ADVANCING, delay_s=1.0),
    11: Trigger(Moment.DAECHA_RETURNING, delay_s=1.0),
    12: Trigger(Moment.ROBOT_1_PICKING, delay_s=1.0, lasts_s=10.0, slow_factor=1.55),
}

DEFAULT_FAULT_CYCLE = 4

PATTERN_LENGTH = 30
SHORT_PARTS_IN_PATTERN = 7


def mostly_60_s_pattern() -> tuple[float, ...]:
    """Fault 6: thirty intervals in seconds, seven of 30 s spread evenly, the first among them.

    The first part follows no BACKWARD_OFF, so 6 of the 29 transitions are short (0.207), as in
    Table 4.
    """
    step = PATTERN_LENGTH / SHORT_PARTS_IN_PATTERN
    short = {round(number * step) for number in range(SHORT_PARTS_IN_PATTERN)}
    return tuple(30.0 if part in short else 60.0 for part in range(PATTERN_LENGTH))


class FaultInjector:
    """Listens to a plant and breaks one thing in one cycle."""

    def __init__(self, plant: CellPlant, fault: FaultDescription, cycle: int) -> None:
        self.fault = fault
        self.began_ns: int | None = None
        self._plant = plant
        self._trigger = TRIGGERS[fault.number]
        self._cycle = cycle
        self._heard = False
        self._name = f"{fault.device}-{fault.signal}"
        plant.listeners.append(self._hear)

    def _hear(self, moment: Moment, cycle: int) -> None:
        if self._heard or moment is not self._trigger.moment or cycle != self._cycle:
            return
        self._heard = True
        if self._trigger.delay_s:
            self._plant.agenda.after(nanoseconds(self._trigger.delay_s), self._begin)
        else:
            self._begin()

    def _begin(self) -> None:
        trigger, plant = self._trigger, self._plant
        self.began_ns = plant.agenda.now_ns
        match self.fault.kind:
            case FaultKind.SENSOR_STUCK_ON:
                plant.sensors.force(self._name, True)
            case FaultKind.SENSOR_DEAD:
                plant.sensors.freeze(self._name)
            case FaultKind.SENSOR_GLITCH:
                plant.sensors.force(self._name, trigger.sensor_value)
            case FaultKind.ACTUATOR_DEAD:
                plant.health[self._name].dead = True
                plant.follow_outputs()
            case FaultKind.ACTUATOR_SLOW:
                health = plant.health[self._name]
                health.extra_response_ns = nanoseconds(trigger.extra_response_s)
                health.slow_factor = trigger.slow_factor
        if trigger.lasts_s is not None:
            plant.agenda.after(nanoseconds(trigger.lasts_s), self._end)

    def _end(self) -> None:
        if self.fault.kind is FaultKind.ACTUATOR_SLOW:
            health = self._plant.health[self._name]
            health.extra_response_ns, health.slow_factor = 0, 1.0
        else:
            self._plant.sensors.release(self._name)
