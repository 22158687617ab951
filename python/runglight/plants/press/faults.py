"""Twenty-four failures of the press, of seven kinds, and what the HMI shows of each."""

from dataclasses import dataclass

from runglight.plants.faults import FaultDescription, FaultKind
from runglight.plants.press.symbols import INPUTS

_BY_NAME = {symbol.short_name: symbol for symbol in INPUTS}


@dataclass(frozen=True, slots=True)
class Failure:
    """A fault's target: a sensor, an actuator, or what is jammed; and where it may show.

    `shows` are the inputs of which one is the right answer to "where shall I look": the one the
    HMI names first. A dead cylinder shows at both its sensors.
    """

    target: str
    shows: tuple[str, ...]


_Pair = tuple[FaultDescription, Failure]


def _fault(
    number: int, name: str, kind: FaultKind, sentence: str, *, target: str, shows: tuple[str, ...]
) -> _Pair:
    symbol = _BY_NAME[shows[0]]
    return (
        FaultDescription(number, name, sentence, kind, symbol.group, symbol.device, symbol.signal),
        Failure(target, shows),
    )


def _sensor(number: int, sensor: str, kind: FaultKind, ending: str, sentence: str) -> _Pair:
    name = f"{sensor.lower().replace('_', '-')}-{ending}"
    return _fault(number, name, kind, sentence, target=sensor, shows=(sensor,))


def _dead(number: int, sensor: str) -> _Pair:
    sentence = f"The sensor {sensor} no longer turns on."
    return _sensor(number, sensor, FaultKind.SENSOR_DEAD, "dead", sentence)


def _stuck(number: int, sensor: str) -> _Pair:
    sentence = f"The sensor {sensor} sticks at on."
    return _sensor(number, sensor, FaultKind.SENSOR_STUCK_ON, "stuck-on", sentence)


def _glitch(number: int, sensor: str) -> _Pair:
    sentence = f"The sensor {sensor} drops out for half a second while it should hold."
    return _sensor(number, sensor, FaultKind.SENSOR_GLITCH, "drops", sentence)


def _trip(number: int, sensor: str, sentence: str) -> _Pair:
    return _sensor(number, sensor, FaultKind.PROTECTION_TRIP, "lost", sentence)


def _cylinder(number: int, device: str, *, slow: bool) -> _Pair:
    both = (f"{device}-ADV", f"{device}-RET")
    kind = FaultKind.ACTUATOR_SLOW if slow else FaultKind.ACTUATOR_DEAD
    name = f"{device.lower()}-{'slow' if slow else 'dead'}"
    what = "moves at a tenth of its speed" if slow else "no longer moves"
    return _fault(number, name, kind, f"{device} {what}.", target=device, shows=both)


def _jam(number: int, what: str, shows: tuple[str, ...], sentence: str) -> _Pair:
    return _fault(
        number, f"{what.lower()}-jammed", FaultKind.JAM, sentence, target=what, shows=shows
    )


_ALL = (
    _dead(1, "Clamp2-ADV"),
    _dead(2, "Punch3-RET"),
    _dead(3, "Drill1-ADV"),
    _dead(4, "Table-RET"),
    _dead(5, "Relays-CLAMPED"),
    _dead(6, "Lift2-ADV"),
    _stuck(7, "Clamp4-RET"),
    _stuck(8, "Tap1-RET"),
    _stuck(9, "Eject1-ADV"),
    _stuck(10, "Transfer-RET"),
    _glitch(11, "Clamp5-ADV"),
    _glitch(12, "Pin1-ADV"),
    _glitch(13, "Guard-RET"),
    _cylinder(14, "Punch1", slow=False),
    _cylinder(15, "Index", slow=False),
    _cylinder(16, "Slide2", slow=False),
    _cylinder(17, "Clamp3", slow=True),
    _cylinder(18, "Drill2", slow=True),
    _trip(19, "Motors-PROTECTION_3", "The protection of motor 3 has tripped."),
    _trip(20, "Hydraulics-OIL_LEVEL_OK", "The hydraulic oil is low."),
    _trip(21, "Inverter-NO_FAULT", "The inverter of the spindle reports a fault."),
    _jam(
        22,
        "Infeed",
        ("Infeed-AT_STOP", "Infeed-WAITING"),
        "A part is jammed on the infeed belt and does not reach the stop.",
    ),
    _jam(
        23,
        "Pressure",
        ("Hydraulics-PRESSURE",),
        "The hydraulic pump no longer builds up pressure.",
    ),
    _jam(24, "Oil", ("OilPump-FLOW", "OilPump-SENSOR_LOW"), "The oil pump no longer lubricates."),
)

FAULTS: dict[int, FaultDescription] = {fault.number: fault for fault, _ in _ALL}
FAILURES: dict[int, Failure] = {fault.number: failure for fault, failure in _ALL}
