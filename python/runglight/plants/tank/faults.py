"""What can break at the tank."""

from runglight.plants.faults import FaultDescription, FaultKind

_DEAD, _STUCK, _SHUT = (
    FaultKind.SENSOR_DEAD,
    FaultKind.SENSOR_STUCK_ON,
    FaultKind.ACTUATOR_DEAD,
)
_ROWS = (
    (1, "ul-dead", _DEAD, "Level", "UL", "The upper sensor sees nothing any more."),
    (2, "ll-dead", _DEAD, "Level", "LL", "The lower sensor sees nothing any more."),
    (3, "ml-stuck-on", _STUCK, "Level", "ML", "The middle sensor hangs."),
    (4, "inv-dead", _SHUT, "Valves", "INV", "The inward valve stays shut."),
    (5, "outv-dead", _SHUT, "Valves", "OUTV", "The outward valve stays shut."),
)
FAULTS = {
    number: FaultDescription(number, name, sentence, kind, "Tank", device, signal)
    for number, name, kind, device, signal, sentence in _ROWS
}
SENSOR_OF = {1: 0, 2: 1, 3: 2}
VALVE_OF = {4: 0, 5: 1}
