"""The tank at work without an end and without a PLC: whoever connects may be its controller."""

from collections.abc import Mapping
from dataclasses import dataclass

from runglight.plants.faults import FaultDescription, FaultKind, FaultLabel, find_fault, label_of
from runglight.plants.running import ChangeListener, Image
from runglight.plants.symbols import Symbol
from runglight.plants.tank.faults import FAULTS, SENSOR_OF, VALVE_OF
from runglight.plants.tank.flows import P1, Flows
from runglight.plants.tank.plant import TankPlant
from runglight.plants.tank.scenarios import SCENARIOS
from runglight.plants.tank.symbols import INPUTS, OUTPUTS, SYMBOLS


@dataclass(slots=True)
class _Injected:
    fault: FaultDescription
    armed_ns: int
    began: bool = False


class RunningTank:
    """A `WritablePlant`: the sensors are its inputs, the valves its outputs, both shut at first."""

    def __init__(self, start_ns: int, seed: int = 1, flows: Flows = P1) -> None:
        self._now_ns = start_ns
        self.plant = TankPlant(start_ns, seed, flows, listener=self._hear)
        self._outputs = [0] * len(OUTPUTS)
        self._listeners: list[ChangeListener] = []
        self._injected: list[_Injected] = []
        self._filled = 0

    @property
    def symbols(self) -> tuple[Symbol, ...]:
        """Three sensors and two valves."""
        return SYMBOLS

    @property
    def faults(self) -> Mapping[int, FaultDescription]:
        """Sensors and valves that fail."""
        return FAULTS

    @property
    def cycles(self) -> int:
        """How often the lower sensor has come free."""
        return self._filled

    def advance(self, now_ns: int) -> None:
        """Lets the liquid flow until `now_ns`."""
        for each in sorted(self._injected, key=lambda each: each.armed_ns):
            if not each.began and each.armed_ns <= now_ns:
                self._advance(each.armed_ns)
                self._begin(each)
        self._advance(now_ns)

    def image(self) -> Image:
        """The sensors, and what the valves have been told."""
        return Image(tuple(map(int, self.plant.read_inputs())), tuple(self._outputs))

    def write(self, number: int, value: int) -> None:
        """Tells valve `number` (0 inward, 1 outward) to open or close, now."""
        value = int(bool(value))
        if self._outputs[number] != value:
            self._outputs[number] = value
            self.plant.write_outputs([bool(each) for each in self._outputs])
            self._tell(self._now_ns, len(INPUTS) + number, value)

    def on_change(self, listener: ChangeListener) -> None:
        """From now on `listener` hears every change of the image."""
        self._listeners.append(listener)

    def inject(self, fault: int | str, at_ns: int | None = None) -> FaultDescription:
        """Breaks something at `at_ns` (None: now)."""
        chosen = find_fault(FAULTS, fault)
        if any(each.fault is chosen for each in self._injected):
            raise ValueError(f"fault {chosen.number} {chosen.name} is there already")
        armed_ns = self._now_ns if at_ns is None else max(at_ns, self._now_ns)
        self._injected.append(_Injected(chosen, armed_ns))
        return chosen

    def labels(self) -> tuple[FaultLabel, ...]:
        """The truth about every fault that has begun."""
        return tuple(label_of(each.fault, each.armed_ns) for each in self._injected if each.began)

    def waiting(self) -> tuple[FaultDescription, ...]:
        """Faults injected that have not begun yet."""
        return tuple(each.fault for each in self._injected if not each.began)

    def acting(self) -> tuple[FaultDescription, ...]:
        """Faults that have begun: none passes."""
        return tuple(each.fault for each in self._injected if each.began)

    def _advance(self, now_ns: int) -> None:
        self._now_ns = max(self._now_ns, now_ns)
        self.plant.advance(self._now_ns)

    def _begin(self, injected: _Injected) -> None:
        injected.began = True
        number = injected.fault.number
        if number in SENSOR_OF:
            self.plant.stick(SENSOR_OF[number], injected.fault.kind is FaultKind.SENSOR_STUCK_ON)
        else:
            self.plant.jam(VALVE_OF[number], is_open=False)

    def _hear(self, time_ns: int, sensor: int, feels: bool) -> None:
        if SYMBOLS[sensor].signal == "LL" and not feels:
            self._filled += 1
        self._tell(time_ns, sensor, int(feels))

    def _tell(self, time_ns: int, number: int, value: int) -> None:
        for listener in self._listeners:
            listener(time_ns, number, value)


def run_tank(start_ns: int, seed: int = 1, scenario: str = "1") -> RunningTank:
    """The tank of a scenario at work, without its program."""
    return RunningTank(start_ns, seed, SCENARIOS[scenario].flows)
