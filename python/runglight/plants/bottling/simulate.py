"""One run of the bottling machine from start to end, as a log."""

from collections.abc import Callable

from runglight.plants.agenda import NS_PER_S
from runglight.plants.bottling.running import RunningBottling
from runglight.plants.bottling.symbols import SYMBOLS
from runglight.plants.image_log import ImageLog
from runglight.plants.run import PlantRun

START_NS = 1_767_592_800 * NS_PER_S
"""2026-01-05T06:00:00Z, a Monday's early shift."""

DEFAULT_BOTTLES = 100

Witness = Callable[[RunningBottling], None]


def simulate_bottling(
    cycles: int | None = None,
    seed: int = 1,
    start_ns: int = START_NS,
    *,
    fault: object = None,
    witness: Witness | None = None,
    witness_every_ns: int = NS_PER_S,
) -> PlantRun:
    """Runs the machine until it has filled `cycles` bottles (default 100); its change log.

    The signals are called by their addresses: of a black box nothing else is known. `witness`
    sees the machine at its start and every `witness_every_ns` from then on, to take a photo of it.
    Raises ValueError for a run without bottles, and for any fault.
    """
    bottles = DEFAULT_BOTTLES if cycles is None else cycles
    if bottles < 1:
        raise ValueError(f"a run has at least 1 bottle, not {bottles}")
    if fault is not None:
        raise ValueError("the bottling machine has no faults; leave out --fault")
    plant = RunningBottling(start_ns, seed)
    log = ImageLog(plant, start_ns)
    now_ns = start_ns
    plant.advance(now_ns)
    while True:
        if witness is not None:
            witness(plant)
        if plant.cycles >= bottles:
            return log.run(now_ns, [symbol.address for symbol in SYMBOLS])
        now_ns += witness_every_ns
        plant.advance(now_ns)
