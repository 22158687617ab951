"""Simulated machines: plant, PLC program and logger, kept apart, with faults to switch on."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from runglight.plants import bodyshop, bottling, cell, press, tank
from runglight.plants.faults import FaultDescription, FaultKind, FaultLabel, find_fault
from runglight.plants.run import PlantRun
from runglight.plants.running import Image, RunningPlant
from runglight.plants.symbols import Symbol, symbols_csv, write_symbols

__all__ = [
    "PLANTS",
    "FaultDescription",
    "FaultKind",
    "FaultLabel",
    "Image",
    "PlantDescription",
    "PlantRun",
    "RunningPlant",
    "Symbol",
    "find_fault",
    "symbols_csv",
    "write_symbols",
]


@dataclass(frozen=True, slots=True)
class PlantDescription:
    """A machine that can be simulated: what it is, its signals and faults, and how to run it.

    `simulate` takes at least `cycles`, `seed`, `fault`, `fault_cycle` and `start_ns`, all optional.
    A plant that comes in `sizes` has no faults, and its symbols are its run's; its `simulate`
    takes `size`, `seed`, `events` and `part`.

    A plant that comes in `scenarios` runs for a time instead of cycles; its `simulate` takes
    `scenario`, `seed` and `lasting_s`, and its `run` a scenario after the seed.

    `run(start_ns, seed)` gives the plant at work, to be advanced from outside; None for a plant
    that exists as a log only.
    """

    name: str
    description: str
    symbols: tuple[Symbol, ...]
    faults: Mapping[int, FaultDescription]
    simulate: Callable[..., PlantRun]
    sizes: tuple[str, ...] = ()
    run: Callable[..., RunningPlant] | None = None
    has_photos: bool = False
    """Its running plant is a `PhotographedPlant`, and `simulate` takes a `witness`."""
    scenarios: tuple[str, ...] = ()


PLANTS: dict[str, PlantDescription] = {
    "cell": PlantDescription(
        name="cell",
        description=(
            "A part loader, two robots and a clamping table (Daecha) place, seal and pass on one "
            "part after another."
        ),
        symbols=cell.SYMBOLS,
        faults=cell.FAULTS,
        simulate=cell.simulate_cell,
        run=cell.RunningCell,
    ),
    "press": PlantDescription(
        name="press",
        description=(
            "A forming press on a Siemens S7 with 216 inputs in five regions, work and set-up "
            "cycles, an operator and an HMI with alarms, like the machine of Guim & Dias 2023."
        ),
        symbols=press.SYMBOLS,
        faults=press.FAULTS,
        simulate=press.simulate_press,
        run=press.RunningPress,
    ),
    "bottling": PlantDescription(
        name="bottling",
        description=(
            "A machine that fills and caps bottles on a Schneider M340, a black box of 100 %M and "
            "300 %MW with photos of its two stations, like the one of Cadiou 2019."
        ),
        symbols=bottling.SYMBOLS,
        faults={},
        simulate=bottling.simulate_bottling,
        run=bottling.RunningBottling,
        has_photos=True,
    ),
    "tank": PlantDescription(
        name="tank",
        description=(
            "A tank of 100 gallons with three level sensors and two valves (Theis 2019), and the "
            "two programs that were mined from it; served, it waits for a controller."
        ),
        symbols=tank.SYMBOLS,
        faults=tank.FAULTS,
        simulate=tank.simulate_tank,
        run=tank.run_tank,
        scenarios=tuple(tank.SCENARIOS),
    ),
    "bodyshop": PlantDescription(
        name="bodyshop",
        description=(
            "Some hundred cells of a car body shop, whose devices wait for one another: up to "
            "21,960 signals and 4.3 million events, as large as the plants of the PLAT paper."
        ),
        symbols=(),
        faults={},
        simulate=bodyshop.simulate_part,
        sizes=tuple(bodyshop.SIZES),
    ),
}
