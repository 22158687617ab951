"""The signals of the press: 27 input bytes as in Guim & Dias 2023, section 3.3, and its valves."""

from runglight.plants.symbols import Symbol

CHECKS = "Checks"
ACTUATORS = "Actuators"
DRIVE = "Drive"
TRANSPORT = "Transport"
INTERLOCKS = "Interlocks"

INPUT_BYTES = 27

# byte -> device -> signals, by bit; what is not named is a reserve that nothing is wired to
_CHECKS: dict[int, tuple[tuple[str, str], ...]] = {
    0: tuple(
        ("Cabinet", name)
        for name in (
            "E_STOP_OK",
            "MAINS_ON",
            "CONTROL_24V",
            "MOTOR_POWER",
            "FAN_POWER",
            "PHASES_OK",
            "TEMP_OK",
            "UPS_OK",
        )
    ),
    1: (
        ("Doors", "FRONT_CLOSED"),
        ("Doors", "REAR_CLOSED"),
        ("Doors", "LEFT_CLOSED"),
        ("Doors", "RIGHT_CLOSED"),
        ("Doors", "LOCKED"),
        ("Doors", "CURTAIN_OK"),
    ),
    2: (("Air", "PRESSURE_OK"), ("Air", "DRYER_OK"), ("Air", "FLOW_OK"), ("Vacuum", "OK")),
    3: (
        ("Hydraulics", "PUMP_RUNS"),
        ("Hydraulics", "OIL_LEVEL_OK"),
        ("Hydraulics", "OIL_TEMP_OK"),
        ("Hydraulics", "FILTER_OK"),
        ("Hydraulics", "PRESSURE"),
        ("Hydraulics", "COOLER_OK"),
    ),
    4: tuple(("Motors", f"PROTECTION_{number}") for number in range(1, 9)),
    5: (
        ("OilPump", "SENSOR_LOW"),
        ("OilPump", "FLOW"),
        ("OilPump", "TANK_OK"),
        ("Coolant", "LEVEL_OK"),
        ("Coolant", "FLOW_OK"),
    ),
    7: (
        ("Panel", "KEY_MANUAL"),
        ("Panel", "RESET"),
        ("Panel", "START"),
        ("Panel", "LAMPS_OK"),
        ("Panel", "STOP"),
    ),
}

ACTUATORS_BY_BYTE: dict[int, tuple[str, ...]] = {
    8: ("Pin1", "Pin2", "Guard"),
    9: ("Stop1", "Stop2"),
    10: ("Lift1", "Lift2"),
    11: ("Centre1", "Centre2"),
    12: ("Clamp1", "Clamp2", "Clamp3", "Clamp4"),
    13: ("Clamp5", "Clamp6"),
    14: ("Punch1", "Punch2", "Punch3", "Punch4"),
    15: ("Drill1", "Drill2", "Drill3"),
    16: ("Tap1", "Tap2"),
    17: ("Table", "Index"),
    18: ("Eject1", "Eject2"),
    19: ("Grip1", "Grip2"),
    20: ("Slide1", "Slide2"),
}
"""Actuators with two end sensors each, by the byte their sensors are wired to."""

ACTUATOR_NAMES = tuple(name for names in ACTUATORS_BY_BYTE.values() for name in names)

CARRIAGES = ("Transfer", "Removal")
"""Carriages of the transporters, with two end sensors each as well."""

_OTHER: dict[int, tuple[tuple[str, str, str], ...]] = {
    21: tuple(
        (DRIVE, "Inverter", name)
        for name in ("READY", "NO_FAULT", "RUNNING", "AT_SPEED", "STANDSTILL", "BRAKE_OPEN")
    ),
    22: (
        (TRANSPORT, "Infeed", "WAITING"),
        (TRANSPORT, "Infeed", "AT_STOP"),
        (TRANSPORT, "Infeed", "MOTOR_OK"),
    ),
    23: (
        (TRANSPORT, "Transfer", "ADV"),
        (TRANSPORT, "Transfer", "RET"),
        (TRANSPORT, "Transfer", "PART_ON"),
    ),
    24: (
        (TRANSPORT, "Removal", "ADV"),
        (TRANSPORT, "Removal", "RET"),
        (TRANSPORT, "Removal", "PART_ON"),
    ),
    25: (
        (TRANSPORT, "Outfeed", "ENTRY"),
        (TRANSPORT, "Outfeed", "EXIT"),
        (TRANSPORT, "Outfeed", "MOTOR_OK"),
    ),
    26: tuple(
        (INTERLOCKS, "Relays", name)
        for name in ("CLAMPED", "UNCLAMPED", "TOOLS_HOME", "TABLE_LOCKED", "PINS_IN", "PRESS_FREE")
    ),
}

_MEMORY = (
    ("WORK_COMPLETE", "the machine performs its work; OFF: it is set up"),
    ("MANUAL", "an operator moves the machine by hand"),
    ("ALARM", "the machine has stopped, and the HMI says why"),
)


def _inputs() -> tuple[Symbol, ...]:
    symbols: list[Symbol] = []
    for byte in range(INPUT_BYTES):
        named: list[tuple[str, str, str]] = []
        if byte in ACTUATORS_BY_BYTE:
            for device in ACTUATORS_BY_BYTE[byte]:
                named += [(ACTUATORS, device, "ADV"), (ACTUATORS, device, "RET")]
        elif byte in _OTHER:
            named += _OTHER[byte]
        else:
            named += [(CHECKS, device, signal) for device, signal in _CHECKS.get(byte, ())]
        for bit in range(8):
            group, device, signal = (
                named[bit] if bit < len(named) else (CHECKS, f"Reserve{byte}", f"BIT_{bit}")
            )
            text = "reserve" if device.startswith("Reserve") else f"{device}: {signal}"
            symbols.append(Symbol(f"I{byte}.{bit}", group, device, signal, "input", text))
    return tuple(symbols)


def _outputs() -> tuple[Symbol, ...]:
    valves = [(ACTUATORS, name, "VALVE") for name in ACTUATOR_NAMES]
    valves += [(TRANSPORT, name, "FORWARD") for name in CARRIAGES]
    valves += [
        (DRIVE, "Inverter", "RUN"),
        (CHECKS, "Hydraulics", "LOAD"),
        (CHECKS, "OilPump", "LUBRICATE"),
        (TRANSPORT, "Infeed", "BELT"),
        (TRANSPORT, "Outfeed", "BELT"),
    ]
    return tuple(
        Symbol(f"Q{n // 8}.{n % 8}", group, device, signal, "output", f"{device}: {signal}")
        for n, (group, device, signal) in enumerate(valves)
    )


def _memory() -> tuple[Symbol, ...]:
    return tuple(
        Symbol(f"M0.{bit}", CHECKS, "Mode", signal, "memory", text)
        for bit, (signal, text) in enumerate(_MEMORY)
    )


INPUTS = _inputs()
OUTPUTS = _outputs()
MEMORY = _memory()
SYMBOLS = INPUTS + OUTPUTS + MEMORY

MODES = {"work_complete": "M0.0", "manual": ["M0.1"], "alarm": ["M0.2"]}
"""`[modes]` of the press."""

REGIONS: dict[str, str | list[str]] = {
    "1-checks": "I0.0-I7.7",
    "2-actuators": "I8-I20 by byte",
    "3-inverter": "I21",
    "4-transport": "I22-I25",
    "5-interlocks": "I26",
}
"""`[regions]` of the press: the five of the paper, the actuators byte by byte."""
