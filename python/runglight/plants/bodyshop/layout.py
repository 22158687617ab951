"""Which devices a plant has, in which cells of which groups, and their signals."""

from dataclasses import dataclass, field
from random import Random

from runglight.plants.bodyshop.kinds import CONVEYOR, FOLLOWERS, Kind
from runglight.plants.bodyshop.sizes import Size
from runglight.plants.bodyshop.steps import Cycle
from runglight.plants.symbols import Symbol, bit_address

CELL_DEVICES = (5, 6, 7, 8)
SPREAD_SIGNALS = 9
"""A device has up to so many signals more than the fewest of its kind, before the total is met."""


@dataclass(slots=True)
class Device:
    """One device: its place and cycle. `signal_of` counts into the signals of the plant."""

    group: str
    name: str
    kind: Kind
    signals: int
    cycle: Cycle
    signal_of: dict[str, int] = field(default_factory=dict)


Cell = list[Device]


def lay_out(size: Size, random: Random) -> list[list[Cell]]:
    """The cells of every group in line order, each led by a conveyor."""
    groups = [
        _cells(f"Group{number + 1}", devices, random)
        for number, devices in enumerate(size.devices_of_groups)
    ]
    devices = [device for group in groups for cell in group for device in cell]
    _meet_total(devices, size.signals, random)
    signals = 0
    for device in devices:
        device.cycle = device.kind.cycle(device.signals)
        device.signal_of = {
            name: signals + place for place, name in enumerate(device.cycle.signals)
        }
        signals += device.signals
    return groups


def _cells(group: str, devices: int, random: Random) -> list[Cell]:
    shares = [kind.share for kind in FOLLOWERS]
    numbers: dict[str, int] = {}

    def device(kind: Kind) -> Device:
        number = numbers[kind.name] = numbers.get(kind.name, 0) + 1
        signals = kind.fewest_signals + random.randrange(SPREAD_SIGNALS)
        return Device(group, f"{kind.name}{number:03}", kind, signals, CONVEYOR.cycle(8))

    cells: list[Cell] = []
    while devices > 0:
        # No remainder too small to be a cell.
        least, most = CELL_DEVICES[0], CELL_DEVICES[-1]
        many = devices if devices <= most else min(random.choice(CELL_DEVICES), devices - least)
        followers = random.choices(FOLLOWERS, shares, k=many - 1)
        cells.append([device(CONVEYOR), *(device(kind) for kind in followers)])
        devices -= many
    return cells


def _meet_total(devices: list[Device], signals: int, random: Random) -> None:
    """Adds or takes away one signal here and there until the plant has as many as it shall."""
    missing = signals - sum(device.signals for device in devices)
    while missing:
        device = random.choice(devices)
        step = 1 if missing > 0 else -1
        if step > 0 or device.signals > device.kind.fewest_signals:
            device.signals += step
            missing -= step


def symbol_table(groups: list[list[Cell]]) -> tuple[Symbol, ...]:
    """The symbol table of the plant, by signal."""
    symbols: list[Symbol] = []
    inputs = outputs = 0
    for device in (device for group in groups for cell in group for device in cell):
        for name in device.signal_of:
            sentence = f"{device.name} {device.kind.sentence}: {name}"
            if name.isupper():
                address = bit_address("Q", outputs)
                outputs += 1
                symbols.append(Symbol(address, device.group, device.name, name, "output", sentence))
            else:
                address = bit_address("I", inputs)
                inputs += 1
                symbols.append(Symbol(address, device.group, device.name, name, "input", sentence))
    return tuple(symbols)
