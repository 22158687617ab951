"""The tank, served over Modbus TCP, with whoever controls it and whoever looks on: one event loop,
one virtual time, real sockets."""  # noqa: D205, D209

import asyncio
import json
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from runglight._engine import Controller, Shadow
from runglight.control.link import PlantLink
from runglight.control.loop import ScanLoop, Stepper
from runglight.control.steppers import Beside, InControl
from runglight.control.terminals import Terminals
from runglight.log.changelog import Log
from runglight.plants.run import PlantRun
from runglight.plants.tank import SYMBOLS, RunningTank
from runglight.plants.tank.flows import Flows
from runglight.plants.tank.ladder import Ladder, LadderProgram
from runglight.plants.tank.simulate import SCAN_NS, START_NS
from runglight.softplc import PlcChange, serve
from runglight.softplc.remote_program import remote_program
from runglight.taps import open_tap
from runglight.taps.grid import Grid
from runglight.taps.virtual_clock import VirtualClock

SECOND_NS = 1_000_000_000
ADDRESS = {symbol.name: symbol.address for symbol in SYMBOLS}
RESET = "%IX0.1=0"


PATIENT = "timeout=120s"
"""A busy computer is no lost connection: virtual time waits for whoever is slow."""
AWAKE_NS = 600_000_000
"""Every scan is run for so long after anything has changed."""


class SparseGrid(Grid):
    """The PLC's grid without the scans in which provably nothing can have changed: hours take
    minutes, and what is seen is the same."""  # noqa: D205, D209

    def __init__(self, plant: RunningTank, changed_ns: Callable[[], int]) -> None:
        super().__init__(SCAN_NS)
        self._plant = plant
        self._changed_ns = changed_ns

    def next_ns(self, now_ns: int) -> int:
        """The next slot at which something can be seen."""
        due_ns = self._plant.plant.next_event_ns()
        if now_ns - self._changed_ns() > AWAKE_NS and due_ns is not None:
            return super().next_ns(max(now_ns, due_ns))
        return super().next_ns(now_ns)


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
        return merged((c.time_ns, ADDRESS[c.signal], c.value) for c in self.changes)

    @property
    def traces(self) -> list[tuple[str, ...]]:
        """Whole runs, from one reset to the next."""
        return whole_traces(self.activities)


def merged(changes: Iterable[tuple[int, str, int]]) -> list[str]:
    """Time, address and value as activities: outputs of one moment are one."""
    words: list[str] = []
    last: tuple[int, bool] | None = None
    for time_ns, address, value in changes:
        key = (time_ns, address.startswith("%Q"))
        word = f"{address}={value}"
        if key[1] and key == last:
            words[-1] += f" & {word}"
        else:
            words.append(word)
        last = key
    return words


def activities_of(run: PlantRun) -> list[str]:
    """The activities of a simulated run."""
    rows = zip(run.time_ns, run.signal_index, run.value, strict=True)
    return merged((int(t), run.signals[n], int(v)) for t, n, v in list(rows)[:-1])


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
    sparse: bool = True,
) -> Outcome:
    """Lets a program or a learned controller work for so long; a shadow and a tap may look on."""
    work = _Work(RunningTank(START_NS, seed, flows), sparse=sparse)
    if fault is not None:
        work.plant.inject(fault, START_NS + 60 * SECOND_NS)
    return asyncio.run(work.run(by, seconds, shadow, tap=tap))


class _Work:
    """One run."""

    def __init__(self, plant: RunningTank, *, sparse: bool) -> None:
        self.plant = plant
        self._sparse = sparse
        self._clock = VirtualClock(START_NS, patience_s=120.0)
        self._outcome = Outcome()
        self._changed_ns = START_NS
        plant.on_change(self._hear)

    async def run(
        self,
        by: Ladder | Controller | LadderProgram,
        seconds: float,
        shadow: Shadow | None,
        *,
        tap: bool,
    ) -> Outcome:
        outcome = self._outcome
        until_ns = START_NS + round(seconds * SECOND_NS)
        async with serve(self.plant, "modbus://127.0.0.1:0", self._clock, keep_changes=True) as plc:
            url = f"{plc.url}?{PATIENT}"
            loops = [self._controlling(by, url)]
            if shadow is not None:
                loops.append(self._loop(shadow.terminals, url, Beside(shadow, self._tell)))
            tasks = [asyncio.create_task(loop.run(until_ns)) for loop in loops]
            if tap:
                outcome.log = await _recorded(plc.tap_url, self._clock, until_ns)
            await asyncio.gather(*tasks)
            outcome.changes = [change for change in plc.changes if change.time_ns < until_ns]
            outcome.scans = loops[0].scans
        tank = self.plant.plant
        outcome.lowest, outcome.highest, outcome.spilt = tank.lowest, tank.highest, tank.spilt
        return outcome

    def _tell(self, lines: list[str]) -> None:
        self._outcome.findings.extend(map(json.loads, lines))

    def _hear(self, time_ns: int, number: int, value: int) -> None:
        del number, value
        self._changed_ns = max(self._changed_ns, time_ns)

    def _grid(self) -> Grid:
        return SparseGrid(self.plant, lambda: self._changed_ns) if self._sparse else Grid(SCAN_NS)

    def _controlling(self, by: Ladder | Controller | LadderProgram, url: str) -> ScanLoop:
        if isinstance(by, Controller):
            return self._loop(by.terminals, url, InControl(by, self._tell))
        program = LadderProgram(by) if isinstance(by, Ladder) else by
        return remote_program(program, SYMBOLS, url, clock=self._clock, grid=self._grid())

    def _loop(self, rows: list[tuple[str, str]], url: str, stepper: Stepper) -> ScanLoop:
        return ScanLoop(PlantLink(url, Terminals.of(rows)), self._clock, self._grid(), stepper)


async def _recorded(url: str, clock: VirtualClock, until_ns: int) -> Log:
    times: list[Any] = []
    signals: list[Any] = []
    values: list[Any] = []
    async with open_tap(
        url.replace("interval=10ms", f"interval=100ms&{PATIENT}"), clock=clock
    ) as tap:
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
