"""The demo's machine: a simulated cell at a real Modbus TCP port, recorded, broken and watched.

Its time jumps from event to event while a tap polls every scan, so that half an hour of work takes
a minute; shortly before the fault shows, time flows as everybody's does, so that what is measured
from the change in the PLC to the printed finding is real.
"""

from __future__ import annotations

import asyncio
import contextlib
import sys
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from runglight.cli import terminal
from runglight.configuration import Symbols
from runglight.findings.finding import Finding, decode_finding
from runglight.live.batch_watcher import BatchWatcher
from runglight.live.keeper import Keeper
from runglight.live.session import Session
from runglight.live.signal_names import model_names
from runglight.plants import symbols_csv
from runglight.plants.agenda import NS_PER_S, nanoseconds
from runglight.plants.cell.running import RunningCell
from runglight.plants.cell.simulate import START_NS
from runglight.recording.recorder import Recorder
from runglight.softplc import serve
from runglight.taps import open_tap
from runglight.taps.virtual_clock import VirtualClock

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable
    from pathlib import Path

    from runglight.model import NominalModel
    from runglight.plants.faults import FaultLabel
    from runglight.plants.running import RunningPlant
    from runglight.softplc import SoftPlc
    from runglight.taps.clock import Clock

SEED = 1
SOUND_S = 30.0
"""Watched before anything is broken."""
REAL_TIME_BEFORE_S = 1.5
"""How long before the fault shows time becomes real."""
AFTER_S = 2.0
"""Watched after the first alarm."""
SHOWS_WITHIN_S = 3 * 3600.0
"""No fault of the cell needs longer."""
GIVEN_UP_AFTER_S = 900.0
"""Watched on after a fault has shown."""
STEP_NS = NS_PER_S


@dataclass
class Watched:
    """What watching told, and when."""

    lines: list[str] = field(default_factory=list)
    first_alarm: Finding | None = None
    told_ns: int = 0
    """When the first alarm was out, in the machine's time."""
    latency_ms: float | None = None
    """From the PLC's change to the printed alarm; None where time was not real, or no change is
    what was told."""
    rows: int = 0
    machine_s: float = 0.0
    """How long it was watched, in the machine's time."""


class DemoMachine:
    """The cell and its PLC: `async with demo_machine() as machine`."""

    def __init__(self, plant: RunningPlant, plc: SoftPlc, clock: VirtualClock) -> None:
        self._plant = plant
        self._plc = plc
        self._clock = clock

    @property
    def url(self) -> str:
        """Where a tap finds it."""
        return self._plc.tap_url

    @property
    def clock(self) -> Clock:
        """Its time."""
        return self._clock

    def run_on(self) -> None:
        """From now on its time flows as everybody's does."""
        self._clock.run_on()

    @property
    def symbols(self) -> str:
        """Its symbol table, as `symbols.csv`."""
        return symbols_csv(self._plc.symbols)

    async def record(self, directory: Path, cycles: int) -> float:
        """Records so many cycles of a sound machine; returns how many seconds of its time."""
        # In a task of its own: who has slept by the clock takes part in it until it ends.
        return await asyncio.create_task(self._record(directory, cycles))

    async def _record(self, directory: Path, cycles: int) -> float:
        began_ns = self._clock.now_ns()
        async with open_tap(self.url, clock=self._clock) as tap:
            with (
                Recorder(directory, tap) as recorder,
                terminal.progressing("Recording", cycles) as advance,
            ):
                begun = 0
                async for batch in tap:
                    recorder.append(batch)
                    now_begun = min(self._plant.cycles, cycles + 1)
                    advance(max(now_begun - begun, 0))
                    begun = now_begun
                    if begun > cycles:
                        break
        return (self._clock.now_ns() - began_ns) / NS_PER_S

    async def watch_broken(
        self,
        fault: str,
        model: NominalModel,
        model_directory: Path,
        directory: Path,
        tell: Callable[[Finding], None],
    ) -> Watched:
        """Watches the machine, breaks it meanwhile, and goes on until the fault has been told."""
        began_ns = self._clock.now_ns()
        at_ns = began_ns + nanoseconds(SOUND_S)
        foreseen = _foreseen(fault, began_ns, at_ns)
        self._plc.inject(fault, at_ns)
        watched = Watched()
        async with open_tap(self.url, clock=self._clock) as tap:
            recorder = Recorder(directory, tap)

            def told(lines: list[str]) -> None:
                for line in lines:
                    finding = decode_finding(line)
                    if watched.first_alarm is None and finding.severity != "notice":
                        tell(finding)
                        sys.stdout.flush()
                        watched.first_alarm, watched.told_ns = finding, self._clock.now_ns()
                watched.lines += lines

            session = Session(
                tap,
                BatchWatcher(model, model.monitor(), tap.signals, model_names(model, Symbols())),
                Keeper(model_directory, terminal.note),
                tell=told,
                say=terminal.note,
                recording=recorder,
            )
            self._clock.on_advance(self._ending(session, foreseen, watched))
            await session.run()
            watched.rows = recorder.rows
            watched.machine_s = (self._clock.now_ns() - began_ns) / NS_PER_S
        watched.latency_ms = self._latency_ms(watched)
        return watched

    def _ending(
        self, session: Session, foreseen: FaultLabel | None, watched: Watched
    ) -> Callable[[int], None]:
        """Hears the time: makes it real, and ends the session when there is no more to be told."""
        clock = self._clock
        shown_ns = None if foreseen is None else foreseen.shown_ns
        real_from_ns = None
        # What stops the line shows by minutes of silence: nobody wants to wait for those.
        if shown_ns is not None and foreseen is not None and foreseen.faulty is not None:
            real_from_ns = shown_ns - nanoseconds(REAL_TIME_BEFORE_S)
        longest_s = SHOWS_WITHIN_S if shown_ns is None else GIVEN_UP_AFTER_S
        end_ns = (shown_ns or clock.now_ns()) + nanoseconds(longest_s)

        def hear(now_ns: int) -> None:
            if watched.first_alarm is not None:
                if now_ns >= watched.told_ns + nanoseconds(AFTER_S):
                    session.stop()
            elif now_ns >= end_ns:
                session.stop()
            elif real_from_ns is not None and now_ns >= real_from_ns:
                clock.run_on()

        return hear

    def _latency_ms(self, watched: Watched) -> float | None:
        alarm = watched.first_alarm
        if alarm is None or not self._clock.is_real or alarm.kind == "stall":
            return None
        name = f"{alarm.group}-{alarm.device}-{alarm.signal}"
        changes = [
            change.time_ns
            for change in self._plc.changes
            if change.signal == name and change.time_ns <= watched.told_ns
        ]
        return (watched.told_ns - changes[-1]) / 1e6 if changes else None


@contextlib.asynccontextmanager
async def demo_machine() -> AsyncIterator[DemoMachine]:
    """Serves the cell at a free port of this computer."""
    clock = VirtualClock(START_NS)
    plant = RunningCell(START_NS, SEED)
    async with serve(plant, "modbus://127.0.0.1:0", clock, keep_changes=True) as plc:
        yield DemoMachine(plant, plc, clock)


def _foreseen(fault: str, now_ns: int, at_ns: int) -> FaultLabel | None:
    """The same machine run ahead: when the fault will show. None where no row shows it."""
    twin = RunningCell(START_NS, SEED)
    twin.advance(now_ns)
    twin.inject(fault, at_ns)
    end_ns = at_ns + nanoseconds(SHOWS_WITHIN_S)
    while now_ns < end_ns:
        now_ns += STEP_NS
        twin.advance(now_ns)
        for label in twin.labels():
            if label.shown_ns is not None:
                return label
    return None
