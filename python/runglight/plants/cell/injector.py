"""What sets the cell's faults off, and how they act.

A fault acts on a sensor, an actuator or the parts, never on the log: the log is what then happens.
"""

from dataclasses import dataclass

from runglight.plants.agenda import nanoseconds
from runglight.plants.cell.feeding import mostly_60_s_pattern
from runglight.plants.cell.plant import CellPlant, Moment
from runglight.plants.faults import FaultDescription, FaultKind


@dataclass(frozen=True, slots=True)
class Trigger:
    """When a fault begins, how long it lasts (None: for good), and how bad it is."""

    moment: Moment
    delay_s: float = 0.0
    lasts_s: float | None = None
    sensor_value: bool = True
    extra_response_s: float = 0.0
    slow_factor: float = 1.0


# A slow actuator recovers after its one motion.
TRIGGERS: dict[int, Trigger] = {
    1: Trigger(Moment.LOADER_RETURNING, delay_s=1.0, lasts_s=0.8),
    2: Trigger(Moment.ROBOT_1_PICKING, delay_s=1.0),
    3: Trigger(Moment.DAECHA_ADVANCING, delay_s=1.0, lasts_s=10.0, extra_response_s=2.09),
    4: Trigger(Moment.ROBOT_1_MOVING, delay_s=5.0, lasts_s=0.8, sensor_value=False),
    5: Trigger(Moment.PART_SET),
    6: Trigger(Moment.POWER_ON),
    7: Trigger(Moment.POWER_ON, delay_s=12.0, lasts_s=2.0, sensor_value=False),
    # between the report of the placed part and the program's answer, 0.1 s later
    8: Trigger(Moment.ROBOT_1_PLACED, delay_s=0.03, lasts_s=0.5),
    9: Trigger(Moment.ROBOT_1_PLACED, lasts_s=10.0, extra_response_s=2.54),
    10: Trigger(Moment.LOADER_ADVANCING, delay_s=1.0),
    11: Trigger(Moment.DAECHA_RETURNING, delay_s=1.0),
    12: Trigger(Moment.ROBOT_1_PICKING, delay_s=1.0, lasts_s=10.0, slow_factor=1.55),
}

TRIGGERS_AT_WORK: dict[int, Trigger] = TRIGGERS | {
    6: Trigger(Moment.PART_SET),
    # long after the program has answered, long before the next part
    7: Trigger(Moment.LOADER_HOME, delay_s=12.0, lasts_s=2.0, sensor_value=False),
}
"""For a cell that has been switched on already."""


class FaultInjector:
    """Listens to a plant and breaks one thing once.

    In cycle `cycle`, or, where that is None, at the next possible moment from `armed_ns` on.
    """

    def __init__(
        self,
        plant: CellPlant,
        fault: FaultDescription,
        trigger: Trigger,
        *,
        cycle: int | None = None,
        armed_ns: int | None = None,
    ) -> None:
        self.fault = fault
        self.began_ns: int | None = None
        self.passed = False
        self._plant = plant
        self._trigger = trigger
        self._cycle = cycle
        self._name = f"{fault.device}-{fault.signal}"
        if armed_ns is None:
            self._arm()
        else:
            plant.agenda.after(armed_ns - plant.agenda.now_ns, self._arm)

    def _arm(self) -> None:
        self._plant.listeners.append(self._hear)

    def _hear(self, moment: Moment, cycle: int) -> None:
        if moment is not self._trigger.moment or self._cycle not in {None, cycle}:
            return
        self._plant.listeners.remove(self._hear)
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
            case FaultKind.PART_PATTERN:
                plant.feed.change(mostly_60_s_pattern(), first=plant.parts_set)
        if trigger.lasts_s is not None:
            plant.agenda.after(nanoseconds(trigger.lasts_s), self._end)

    def _end(self) -> None:
        self.passed = True
        if self.fault.kind is FaultKind.ACTUATOR_SLOW:
            health = self._plant.health[self._name]
            health.extra_response_ns, health.slow_factor = 0, 1.0
        else:
            self._plant.sensors.release(self._name)
