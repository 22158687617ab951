"""One run of the tank with its program, as a log."""

from runglight.plants.agenda import NS_PER_S, nanoseconds
from runglight.plants.logger import ChangeLogger
from runglight.plants.run import PlantRun
from runglight.plants.scan import ScanCycle
from runglight.plants.tank.ladder import Ladder, LadderProgram
from runglight.plants.tank.plant import TankPlant
from runglight.plants.tank.scenarios import SCENARIOS
from runglight.plants.tank.symbols import INPUTS, OUTPUTS, SYMBOLS

START_NS = 1_767_592_800 * NS_PER_S
"""2026-01-05T06:00:00Z, a Monday's early shift."""

PAPER_S = 880.0
"""How long each scenario was recorded (Theis 2019, section VI-C)."""

SCAN_NS = 100_000_000


def simulate_tank(
    scenario: str = "1",
    seed: int = 1,
    lasting_s: float = PAPER_S,
    start_ns: int = START_NS,
    *,
    program: Ladder | None = None,
) -> PlantRun:
    """Runs a scenario (`1`, `2` or `3`) for `lasting_s` seconds; signals are called by address.

    The tank begins empty, and the PLC scans every 100 ms. `program` takes the place of the
    scenario's. Raises ValueError for a scenario that does not exist.
    """
    if scenario not in SCENARIOS:
        raise ValueError(f"there is no scenario {scenario!r}; there are {', '.join(SCENARIOS)}")
    if not lasting_s > 0:
        raise ValueError(f"a run lasts longer than {lasting_s:g} s")
    chosen = SCENARIOS[scenario]
    plant = TankPlant(start_ns, seed, chosen.flows)
    logger = ChangeLogger(range(len(INPUTS)), range(len(INPUTS), len(SYMBOLS)))
    cycle = ScanCycle(
        plant,
        LadderProgram(program or chosen.program),
        logger,
        start_ns=start_ns,
        outputs=(False,) * len(OUTPUTS),
        scan_interval_ns=SCAN_NS,
    )
    end_ns = start_ns + nanoseconds(lasting_s)
    cycle.advance(end_ns)
    logger.close(end_ns)
    return PlantRun(
        *logger.columns(),
        signals=tuple(symbol.address for symbol in SYMBOLS),
        labels=(),
        end_ns=end_ns,
    )
