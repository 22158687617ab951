"""How a plant comes to have about as many transition rules as the paper's."""

from random import Random

from runglight.plants.bodyshop.layout import Cell
from runglight.plants.bodyshop.plan import ALARM_RATE
from runglight.plants.bodyshop.sizes import Size


def expected_rules(size: Size, groups: list[list[Cell]]) -> float:
    """Transitions of all devices and groups if no neighbours ever start in the other order."""
    rules = 2.0 * (size.signals + size.devices)
    cycles = size.learn_events / (2 * size.signals)
    for device in (device for cells in groups for cell in cells for device in cell):
        for choice, share in enumerate(device.cycle.shares):
            shape = next(step.shape for step in device.cycle.steps if step.choice == choice)
            if share is None:
                rules += 4 * (1 - (1 - ALARM_RATE) ** cycles)
            else:
                rules += 3 if shape == "either order" else 1
    return rules


def swapping_pairs(size: Size, groups: list[list[Cell]], random: Random) -> list[list[int]]:
    """How many pairs of neighbours of each cell start in an order that depends on the part.

    Each makes three more transitions of the group; as many as bring the rules to their number.
    """
    places = [
        (group, cell)
        for group, cells in enumerate(groups)
        for cell, devices in enumerate(cells)
        for _ in range(len(devices) // 3)
    ]
    random.shuffle(places)
    wanted = round((size.rules - expected_rules(size, groups)) / 3)
    swaps = [[0] * len(cells) for cells in groups]
    for group, cell in places[: max(wanted, 0)]:
        swaps[group][cell] += 1
    return swaps
