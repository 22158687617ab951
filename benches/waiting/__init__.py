"""Plants of another make than the body shop, whose devices wait for one another.

Each is a discrete-event simulation in which a delay holds up whoever waits for it, as in a real
plant. Names say nothing of inputs and outputs, and cause and effect often bear the same time.
"""

from collections.abc import Callable

import runglight as rl
from benches.waiting.line import LineOptions, lines
from benches.waiting.plant import Plant
from benches.waiting.plating import plating
from benches.waiting.rotary_table import rotary_tables

PLANTS: dict[str, Callable[[Plant], None]] = {
    "lines": lambda plant: lines(plant, LineOptions()),
    "lines, busy": lambda plant: lines(plant, LineOptions(takt_s=(5.0, 20.0))),
    "lines, three part types": lambda plant: lines(plant, LineOptions(part_types=3)),
    "lines with people": lambda plant: lines(plant, LineOptions(people=True)),
    "rotary tables": rotary_tables,
    "plating": plating,
}
"""By name."""


def simulate(name: str, seed: int, events: int, *, delayed: bool) -> tuple[Plant, rl.Log, rl.Log]:
    """A run, the part to learn from, and the part to watch.

    Up to the latter the same of a seed, `delayed` or not.
    """
    plant = Plant(seed, events, delayed)
    PLANTS[name](plant)
    learned, watched = plant.run()
    return plant, learned, watched
