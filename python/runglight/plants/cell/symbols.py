"""The signals of the cell: the ones of Ghosh 2016, Table 3, and those it leaves to analogy."""

from runglight.plants.symbols import Symbol, bit_address

GROUP = "Group1"

# device, inputs, outputs; the order of devices and signals is the order of the log's dictionary
_DEVICES: tuple[tuple[str, dict[str, str], dict[str, str]], ...] = (
    (
        "PrtLDR",
        {
            "RET": "part loader stands at its home end",
            "ADV": "part loader stands at its far end, in front of robot 1",
            "PRT_CHK": "a part lies on the part loader",
        },
        {
            "FORWARD": "drive the part loader towards robot 1",
            "BACKWARD": "drive the part loader back home",
        },
    ),
    (
        "DCLAMP",
        {
            "OpSen1": "left clamp is fully open",
            "OpSen2": "right clamp is fully open",
            "ClsSen1": "left clamp is fully closed",
            "ClsSen2": "right clamp is fully closed",
        },
        {
            "CLOSE": "close both clamps",
            "OPEN": "open both clamps",
        },
    ),
    (
        "RBT1",
        {
            "HOME_POS": "robot 1 is in its home position",
            "RUNNING": "robot 1 runs a program",
            "1ST_WORK_COMP": "robot 1 has picked the part up from the part loader",
            "2ND_WORK_COMP": "robot 1 has placed the part on the Daecha",
        },
        {
            "READY": "robot 1 may start its work",
            "PRT_PICK": "robot 1: pick the part up from the part loader",
            "PRT_MOVE": "robot 1: carry the part to the Daecha",
            "RET_HOME": "robot 1: return home; stays on until the part has left the Daecha",
        },
    ),
    (
        "DCHA",
        {
            "RET": "Daecha stands at its home end, where it is loaded",
            "ADV": "Daecha stands at its far end, where it is unloaded",
        },
        {
            "FORWARD": "drive the Daecha to its far end",
            "BACKWARD": "drive the Daecha back home",
        },
    ),
    (
        "RBT2",
        {
            "HOME_POS": "robot 2 is in its home position",
            "RUNNING": "robot 2 runs a program",
            "WORK_COMP": "robot 2 has sealed the part",
        },
        {
            "READY": "robot 2 may start its work",
            "SEAL": "robot 2: seal the part",
            "RET_HOME": "robot 2: return home",
        },
    ),
)


def _make_symbols() -> tuple[Symbol, ...]:
    symbols: list[Symbol] = []
    inputs = outputs = 0
    for device, device_inputs, device_outputs in _DEVICES:
        for signal, description in device_inputs.items():
            address = bit_address("I", inputs)
            symbols.append(Symbol(address, GROUP, device, signal, "input", description))
            inputs += 1
        for signal, description in device_outputs.items():
            address = bit_address("Q", outputs)
            symbols.append(Symbol(address, GROUP, device, signal, "output", description))
            outputs += 1
    return tuple(symbols)


SYMBOLS = _make_symbols()
INPUTS = tuple(symbol for symbol in SYMBOLS if symbol.signal_class == "input")
OUTPUTS = tuple(symbol for symbol in SYMBOLS if symbol.signal_class == "output")
