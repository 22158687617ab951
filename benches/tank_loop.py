"""The tank, served over Modbus TCP, with whoever controls it and whoever looks on: one event loop,
one virtual time, real sockets."""  # noqa: D205, D209

import asyncio
import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from runglight._engine import Controller, Shadow
from runglight.control.link import PlantLink
from runglight.control.loop import ScanLoop, Stepper
from runglight.control.steppers import Beside, InControl
from runglight.control.terminals import Terminals
from runglight.log.changelog import Log
from runglight.plants.tank import SYMBOLS, RunningTank
from runglight.plants.tank.flows import Flows
from runglight.plants.tank.ladder import Ladder, LadderProgram
from runglight.plants.tank.simulate import SCAN_NS, START_NS
from runglight.softplc import PlcChange, serve
from runglight.softplc.remote_program import remote_program
from runglight.taps import open_tap
from runglight.taps.virtual_clock import VirtualClock

SECOND_NS = 1_000_000_000
ADDRESS = {symbol.name: symbol.address for symbol in SYMBOLS}
RESET = "%IX0.1=0"


@dataclass
class Outcome:
    """What happened at the tank."""

    changes: list[PlcChange] = field(default_factory=list)
    lowest: float = 0.0
    highest: float = 0.0
    spilt: float = 0.0
    findings: list[dict[str, Any]] = field(default_factory=list)
    scans: int = 0
    log: Log | None = None

    @property
    def activities(self) -> list[str]:
        """The changes as activities: outputs of one moment are one."""
        words: list[str] = []
        last: tuple[int, bool] | None = None
        for change in self.changes:
            address = ADDRESS[change.signal]
            key = (change.time_ns, address.startswith("%Q"))
            word = f"{address}={change.value}"
            if key[1] and key == last:
                words[-1] += f" & {word}"
            else:
                words.append(word)
            last = key
        return words

    @property
    def traces(self) -> list[tuple[str, ...]]:
        """Whole runs, from one reset to the next."""
        return whole_traces(self.activities)


def whole_traces(activities: Sequence[str]) -> list[tuple[str, ...]]:
    """Cut at the reset; without the first and the last part."""
    traces: list[list[str]] = [[]]
    for word in activities:
        if word == RESET:
            traces.append([])
        traces[-1].append(word)
    return [tuple(trace) for trace in traces[1:-1]]


def at_the_tank(
    by: Ladder | Controller | LadderProgram,
    flows: Flows,
    seconds: float,
    *,
    seed: int = 1,
    shadow: Shadow | None = None,
    tap: bool = False,
    fault: str | None = None,
) -> Outcome:
    """Lets a program or a learned controller work for so long; a shadow and a tap may look on."""
    return asyncio.run(_work(by, flows, seconds, seed, shadow, tap, fault))


async def _work(  # noqa: PLR0917
    by: Ladder | Controller | LadderProgram,
    flows: Flows,
    seconds: float,
    seed: int,
    shadow: Shadow | None,
    tap: bool,
    fault: str | None,
) -> Outcome:
    clock = VirtualClock(START_NS)
    plant = RunningTank(START_NS, seed, flows)
    outcome = Outcome()
    until_ns = START_NS + round(seconds * SECOND_NS)

    def tell(lines: list[str]) -> None:
        outcome.findings.extend(map(json.loads, lines))

    if fault is not None:
        plant.inject(fault, START_NS + 60 * SECOND_NS)
    async with serve(plant, "modbus://127.0.0.1:0", clock, keep_changes=True) as plc:
        url = str(plc.url)
        loops = [_controlling(by, url, clock, tell)]
        if shadow is not None:
            loops.append(_loop(shadow.terminals, url, clock, Beside(shadow, tell)))
        tasks = [asyncio.create_task(loop.run(until_ns)) for loop in loops]
        if tap:
            outcome.log = await _recorded(plc.tap_url, clock, until_ns)
        await asyncio.gather(*tasks)
        outcome.changes = [change for change in plc.changes if change.time_ns < until_ns]
        outcome.scans = loops[0].scans
    outcome.lowest, outcome.highest = plant.plant.lowest, plant.plant.highest
    outcome.spilt = plant.plant.spilt
    return outcome


def _controlling(
    by: Ladder | Controller | LadderProgram, url: str, clock: VirtualClock, tell: Any
) -> ScanLoop:
    if isinstance(by, Controller):
        return _loop(by.terminals, url, clock, InControl(by, tell))
    program = LadderProgram(by) if isinstance(by, Ladder) else by
    return remote_program(program, SYMBOLS, url, clock=clock, interval_ns=SCAN_NS)


def _loop(
    rows: list[tuple[str, str]], url: str, clock: VirtualClock, stepper: Stepper
) -> ScanLoop:
    return ScanLoop(PlantLink(url, Terminals.of(rows)), clock, SCAN_NS, stepper)


async def _recorded(url: str, clock: VirtualClock, until_ns: int) -> Log:
    times: list[Any] = []
    signals: list[Any] = []
    values: list[Any] = []
    async with open_tap(url.replace("interval=10ms", "interval=100ms"), clock=clock) as tap:
        async for batch in tap:
            times.append(batch.time_ns)
            signals.append(batch.signal_index)
            values.append(batch.value)
            if batch.until_ns >= until_ns:
                break
        names = [signal.name for signal in tap.signals]
    return Log.from_columns(
        np.concatenate(times), np.concatenate(signals), np.concatenate(values), names
    )
