"""The memory of the bottling machine as a symbol table: what nobody on site has any more."""

from runglight.plants.bottling.memory import BITS, BUFFER, PRESETS, WORDS
from runglight.plants.symbols import Symbol

_BITS: dict[int, tuple[str, str, str]] = {
    0: ("Mode", "AUTOMATIC", "the machine produces"),
    1: ("Mode", "MANUAL", "the machine is moved by hand"),
    2: ("Mode", "READY", "waits for the start button"),
    5: ("Clock", "BLINK_FAST", "half a second on, half a second off"),
    6: ("Clock", "BLINK_SLOW", "two seconds on, two seconds off"),
    10: ("Filling", "ACTIVE", "the shutter is open"),
    11: ("Capping", "SCREWS", "the cap is being screwed on"),
    12: ("Table", "TURNS", "the rotary table turns"),
    20: ("Panel", "JOG", "HMI button: conveyor in manual"),
    21: ("Panel", "START", "start button"),
    22: ("Panel", "SELECTOR", "selector stands at manual"),
    25: ("Mode", "START_ALLOWED", "start authorisation"),
    30: ("Conveyor", "REQUEST", "copy of the order to the conveyor's motor"),
    60: ("Filling", "QUEUE", "a bottle waits while another is filled"),
    61: ("Capping", "EXPECTED", "a bottle is on its way to station 2"),
    70: ("Air", "WELL", "air pressure is well"),
    71: ("Doors", "WELL", "doors are closed"),
    98: ("Filling", "ORDER", "start order to fill a container"),
    99: ("Filling", "DONE", "a container is full and waits"),
}
_BITS |= {40 + step: ("Filling", f"STEP_{step}", f"step {step} of station 1") for step in range(7)}
_BITS |= {50 + step: ("Capping", f"STEP_{step}", f"step {step} of station 2") for step in range(5)}

_WORDS: dict[int, tuple[str, str, str]] = {
    0: ("Clock", "TENTHS", "tenths of a second since the start"),
    1: ("Clock", "SCANS", "scans since the start"),
    2: ("Clock", "SCAN_TIME", "time of the last scan, ms"),
    4: ("HMI", "SCREEN", "screen to display"),
    6: ("Mode", "STATE", "1 ready, 3 manual, 5 automatic"),
    10: ("Filling", "STEP", "step of station 1"),
    11: ("Capping", "STEP", "step of station 2"),
    12: ("Mode", "STEP", "step of the modes"),
    14: ("HMI", "STATUS", "bits for the HMI's lamps"),
    20: ("Measured", "PUMP_PRESSURE", "mbar"),
    21: ("Measured", "FLOW", "ml/min"),
    22: ("Measured", "TANK_LEVEL", "tenths of a millimetre"),
    23: ("Measured", "TEMPERATURE", "tenths of a degree"),
    24: ("Measured", "AIR_PRESSURE", "mbar"),
    25: ("Measured", "PUMP_CURRENT", "mA"),
    26: ("Measured", "WEIGHT", "of the cap magazine, grams"),
    32: ("Count", "FILLED", "containers filled"),
    33: ("Count", "HMI", "production counter for the HMI"),
    34: ("HMI", "MESSAGE", "message to display"),
    35: ("Count", "DAY", "daily production counter"),
    36: ("Count", "TO_GO", "bottles of the order still to make"),
    50: ("Clock", "YEAR", "year"),
    51: ("Clock", "MONTH", "month"),
    52: ("Clock", "DAY", "day"),
    53: ("Clock", "HOUR", "hour"),
    54: ("Clock", "MINUTE", "minute"),
    55: ("Clock", "SECOND", "second"),
    74: ("Outputs", "WORD_1", "orders to motors, lamps and cylinders"),
    75: ("Outputs", "WORD_2", "orders to the pick-and-place"),
    78: ("HMI", "RULES_1", "display rules (show/hide)"),
    91: ("Filling", "TIME", "time of the last filling, tenths of a second"),
    92: ("Capping", "TORQUE", "of the last cap, tenths of a newton metre"),
    100: ("Count", "RATE", "bottles per hour, every ten seconds"),
    110: ("Clock", "SECONDS", "seconds"),
    111: ("Count", "MINUTES_PRODUCED", "minutes in automatic"),
    112: ("Conveyor", "SECONDS_RUN", "seconds the conveyor has run"),
    128: ("Count", "MINUTE", "products of this minute, for the rate"),
    129: ("Clock", "MINUTE_SECOND", "seconds of the rate's minute"),
    140: ("Inputs", "WORD_1", "sensors"),
    141: ("Inputs", "WORD_2", "panel"),
    142: ("HMI", "HEARTBEAT", "0.7 s on, 0.7 s off"),
    144: ("HMI", "RULES_2", "display rules for buttons (show/hide)"),
    146: ("HMI", "RULES_3", "display rules (show/hide)"),
}
_WORDS |= {number: ("Presets", f"P{number}", "set once") for number in PRESETS}
_WORDS |= {
    number: ("Filling", f"TIME_{place}", "time of a filling, ms")
    for place, number in enumerate(BUFFER)
}


def _symbol(address: str, place: tuple[str, str, str] | None, kind: str) -> Symbol:
    device, signal, description = place or ("Unused", address.strip("%"), "nothing is known of it")
    return Symbol(address, "Bottling", device, signal, "memory", description, kind)


SYMBOLS = (
    *(_symbol(f"%M{number}", _BITS.get(number), "BOOL") for number in range(BITS)),
    *(_symbol(f"%MW{number}", _WORDS.get(number), "UINT") for number in range(WORDS)),
)
