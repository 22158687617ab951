"""What the PLC keeps where: 100 bits `%M` and 300 words `%MW`, addresses as in Cadiou 2019.

The places that the paper names are where it has them (Figures 4 and 6); the others are such as
programs of that make have: copies for the HMI, presets, clocks, measurements, buffers, and room
for what was planned once.
"""

from collections.abc import Iterable, Mapping, Sequence
from datetime import UTC, datetime

from runglight.plants.agenda import NS_PER_S
from runglight.plants.bottling.measurements import Measurements
from runglight.plants.bottling.program import ORDER, BottlingProgram, Mode
from runglight.plants.bottling.terminals import Input, Output

BITS = 100
WORDS = 300

PRESETS = {40: 1_500, 41: 250, 42: 150, 43: 550, 44: 800, 45: 2_400, 46: 124, 60: 12, 61: 3}
"""Recipe and times, set once: `%MW40` is the filling time in milliseconds …"""

BUFFER = range(150, 166)
"""`%MW150` to `%MW165`: how long the last sixteen fillings took, one word after the other."""

OUTPUTS_1 = {
    0: Output.CONVEYOR,
    7: Output.GREEN,
    8: Output.ORANGE,
    10: Output.STOP_1,
    11: Output.STOP_2,
    12: Output.STOP_3,
    13: Output.TABLE,
    14: Output.PUMP,
    15: Output.SHUTTER,
}
"""Bits of `%MW74`."""
OUTPUTS_2 = {
    0: Output.ARM_TO_PLACE,
    1: Output.ARM_TO_PICK,
    2: Output.GRIPPER,
    3: Output.SCREW,
    6: Output.LABELLING,
}
"""Bits of `%MW75`."""
INPUTS_1 = {
    0: Input.PART_AT_STOP,
    1: Input.PART_ON_STATION_1,
    2: Input.PART_AFTER_STATION_1,
    3: Input.STOP_1_OPEN,
    4: Input.STOP_2_OPEN,
    5: Input.PART_ON_STATION_2,
    6: Input.PART_AT_EXIT,
    7: Input.CAP_GRIPPED,
    8: Input.CONTACTOR,
    9: Input.ARM_AT_PICK,
    10: Input.ARM_AT_PLACE,
    11: Input.GROUP_READY,
}
"""Bits of `%MW140`; bits 12 to 15 are doors, air and emergency stop, which are well."""
ALL_WELL = 0xF000

_SCREENS = {Mode.MANUAL: 3, Mode.READY: 2, Mode.WARN: 2, Mode.AUTOMATIC: 1}
_WAITS_FOR_BOTTLES, _FILLS, _CAPS, _IN_MANUAL, _READY = 16, 17, 19, 40, 41


class Memory:
    """The image of the program's memory; `write` brings it up to the last scan."""

    def __init__(self, seed: int) -> None:
        self._measurements = Measurements(seed)
        self._bits = [0] * BITS
        self._words = [0] * WORDS
        for number, value in PRESETS.items():
            self._words[number] = value
        self._bits[70] = self._bits[71] = 1  # air and doors are well
        self._slow_tasks = 0
        self._filled = 0
        self._belt_s = 0.0
        self._produces_s = 0.0

    def write(self, program: BottlingProgram) -> tuple[int, ...]:
        """All bits, then all words."""
        if program.slow_tasks != self._slow_tasks:
            self._slow_tasks = program.slow_tasks
            self._slow(program)
        self._bits_of(program)
        self._words_of(program)
        return (*self._bits, *self._words)

    def _slow(self, program: BottlingProgram) -> None:
        words, outputs = self._words, program.outputs
        seconds = program.now_ns // NS_PER_S
        moment = datetime.fromtimestamp(seconds, UTC)
        self._measurements.measure(
            program.now_ns / NS_PER_S,
            fills=outputs[Output.SHUTTER],
            pump=outputs[Output.PUMP],
        )
        measured = self._measurements
        self._belt_s += 0.1 * outputs[Output.CONVEYOR]
        self._produces_s += 0.1 * program.automatic
        words[0] = program.slow_tasks & 0xFFFF
        words[1] = program.slow_tasks * 11 & 0x7FFF
        words[2] = measured.scan_time_ms
        words[20:27] = (
            measured.pump_pressure,
            measured.flow,
            measured.tank_level,
            measured.temperature,
            measured.air_pressure,
            measured.pump_current,
            measured.weight,
        )
        words[50:56] = (
            moment.year,
            moment.month,
            moment.day,
            moment.hour,
            moment.minute,
            moment.second,
        )
        words[100] = program.rate_per_hour
        words[110] = seconds & 0xFFFF
        words[111] = int(self._produces_s / 60)
        words[112] = int(self._belt_s)
        words[129] = program.slow_tasks // 10 % 60
        words[142] = program.slow_tasks // 7 % 2
        self._bits[5] = program.slow_tasks // 5 % 2
        self._bits[6] = program.slow_tasks // 20 % 2

    def _bits_of(self, program: BottlingProgram) -> None:
        bits, inputs, outputs, mode = self._bits, program.inputs, program.outputs, program.modes
        fill, cap = program.filling.steps.step, program.capping.steps.step
        bits[0] = program.automatic
        bits[1] = mode.step == Mode.MANUAL
        bits[2] = mode.step == Mode.READY
        bits[10:13] = outputs[Output.SHUTTER], outputs[Output.SCREW], outputs[Output.TABLE]
        bits[20:23] = inputs[Input.JOG], inputs[Input.START], inputs[Input.SELECTOR_MANUAL]
        bits[25] = mode.step >= Mode.WARN
        bits[30] = outputs[Output.CONVEYOR]
        bits[40:47] = (fill == step for step in range(7))
        bits[50:55] = (cap == step for step in range(5))
        bits[60] = inputs[Input.PART_AT_STOP] and fill != 0
        bits[61] = program.capping.expected
        bits[98] = fill == 3
        bits[99] = fill == 5

    def _words_of(self, program: BottlingProgram) -> None:
        words, inputs, outputs, mode = self._words, program.inputs, program.outputs, program.modes
        fill, cap = program.filling.steps.step, program.capping.steps.step
        manual = mode.step == Mode.MANUAL
        words[4] = _SCREENS[mode.step]
        words[6] = 4 * program.automatic + 2 * manual + 1
        words[10], words[11], words[12] = fill, cap, mode.step
        words[14] = packed(
            (program.automatic, manual, outputs[Output.CONVEYOR], False, fill != 0, cap > 1)
        )
        words[32] = words[33] = program.produced
        words[35] = 1_310 + program.produced
        words[36] = ORDER - program.produced
        words[128] = program.produced_in_minute
        words[34] = message(program)
        words[74] = _selected(outputs, OUTPUTS_1)
        words[75] = _selected(outputs, OUTPUTS_2)
        words[78] = 0x3C if manual else 0x21 if program.automatic else 0x20
        if program.filling.filled != self._filled:
            self._filled = program.filling.filled
            words[91] = round(program.filling.fill_s * 10)
            words[BUFFER[self._filled % len(BUFFER)]] = round(program.filling.fill_s * 1_000)
        words[92] = program.torque
        words[140] = ALL_WELL | _selected(inputs, INPUTS_1)
        words[141] = packed(
            (inputs[Input.SELECTOR_MANUAL], inputs[Input.START], inputs[Input.JOG], True)
        )
        words[144] = 0x0F if manual else 0x41
        words[146] = packed((fill == 3, cap in (2, 3), program.automatic, manual))


def message(program: BottlingProgram) -> int:
    """The number of the sentence that the HMI shows."""
    if program.modes.step == Mode.MANUAL:
        return _IN_MANUAL
    if not program.automatic:
        return _READY
    if program.filling.steps.step == 3:
        return _FILLS
    return _CAPS if program.capping.steps.step in (2, 3) else _WAITS_FOR_BOTTLES


def packed(bits: Iterable[bool]) -> int:
    """Bits as a word, the lowest first."""
    return sum(bool(bit) << place for place, bit in enumerate(bits))


def _selected(values: Sequence[bool], places: Mapping[int, int]) -> int:
    return sum(values[number] << place for place, number in places.items())
