"""What can break at the tank."""

from runglight.plants.faults import FaultDescription, FaultKind


def _fault(
    number: int, name: str, kind: FaultKind, device: str, signal: str, sentence: str
) -> FaultDescription:
    return FaultDescription(number, name, sentence, kind, "Tank", device, signal)


FAULTS = {
    fault.number: fault
    for fault in (
        _fault(1, "ul-dead", FaultKind.SENSOR_DEAD, "Level", "UL", "The upper sensor sees nothing."),
        _fault(2, "ll-dead", FaultKind.SENSOR_DEAD, "Level", "LL", "The lower sensor sees nothing."),
        _fault(3, "ml-stuck-on", FaultKind.SENSOR_STUCK_ON, "Level", "ML", "The middle sensor hangs."),
        _fault(4, "inv-dead", FaultKind.ACTUATOR_DEAD, "Valves", "INV", "The inward valve stays shut."),
        _fault(5, "outv-dead", FaultKind.ACTUATOR_DEAD, "Valves", "OUTV", "The outward valve stays shut."),
    )
}
SENSOR_OF = {1: 0, 2: 1, 3: 2}
VALVE_OF = {4: 0, 5: 1}
