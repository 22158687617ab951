"""`runglight simulate PLANT --serve URL`: the plant at work, to be tapped as its PLC would be."""

from __future__ import annotations

import asyncio
import signal
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from rich.text import Text

from runglight.cli import terminal
from runglight.cli.counted import counted
from runglight.cli.exit_codes import DONE, INTERRUPTED
from runglight.cli.output import output
from runglight.errors import InputError
from runglight.quantities import duration_s

if TYPE_CHECKING:
    from runglight.cli.simulate_photos import PlantCamera
    from runglight.plants import FaultDescription, PlantDescription, RunningPlant
    from runglight.softplc import SoftPlc
    from runglight.taps.clock import SteadyClock

GLANCE_S = 0.1
"""How often what has happened is told (real seconds)."""


@dataclass(frozen=True, slots=True)
class ServeOptions:
    """What the command line says about serving."""

    url: str
    seed: int
    faults: tuple[str, ...]
    after: tuple[str, ...]
    lasting: str | None
    """How long to serve; None for until it is interrupted."""
    symbols: Path | None
    labels: Path | None
    camera: PlantCamera | None = None
    scenario: str | None = None


def simulate_serve(description: PlantDescription, options: ServeOptions) -> int:
    """Serves a plant; 0 when its time is over, 130 when it was interrupted."""
    if description.run is None:
        raise InputError(
            f"simulate {description.name}: this plant exists as a log only and cannot be served; "
            "simulate cell can"
        )
    from runglight.taps.clock import SteadyClock  # noqa: PLC0415

    lasting_s = None if options.lasting is None else _duration(options.lasting, "--for")
    clock = SteadyClock()
    start_ns = clock.now_ns()
    scenario = () if options.scenario is None else (options.scenario,)
    plant = description.run(start_ns, options.seed, *scenario)
    plan = _plan(plant, options, start_ns)
    return asyncio.run(_Session(description, plant, options, plan).run(clock, lasting_s))


Planned = tuple[tuple["FaultDescription", float], ...]
"""Faults, and the seconds after the start from which on each may begin."""


def _plan(plant: RunningPlant, options: ServeOptions, start_ns: int) -> Planned:
    """Injects the faults; InputError for one the plant has not."""
    after = options.after
    if len(after) > 1 and len(after) != len(options.faults):
        raise InputError(
            f"--after: {counted(len(after), 'time')} for {counted(len(options.faults), 'fault')}; "
            "give one for all, or one for each"
        )
    if after and not options.faults:
        raise InputError("--after: says when, but not what; add --fault")
    delays_s = [_duration(text, "--after") for text in after] or [0.0]
    if len(delays_s) == 1:
        delays_s *= len(options.faults)
    plan: list[tuple[FaultDescription, float]] = []
    for fault, delay_s in zip(options.faults, delays_s, strict=True):
        try:
            plan.append((plant.inject(fault, start_ns + round(delay_s * 1e9)), delay_s))
        except ValueError as error:
            raise InputError(f"--fault: {error}") from None
    return tuple(plan)


def _duration(text: str, name: str) -> float:
    """At most a century: what is longer has no end."""
    seconds = duration_s(text, name)
    if seconds > 100 * 366 * 86_400:
        raise InputError(f"{name}: {text} is longer than any machine lasts")
    return seconds


class _Session:
    """One plant being served, and what the terminal is told of it."""

    def __init__(
        self,
        description: PlantDescription,
        plant: RunningPlant,
        options: ServeOptions,
        plan: Planned,
    ) -> None:
        self._name = description.name
        self._plant = plant
        self._options = options
        self._plan = plan
        self._begun = 0
        self._acting: tuple[FaultDescription, ...] = ()

    async def run(self, clock: SteadyClock, lasting_s: float | None) -> int:
        """Serves until the time is over or somebody ends it."""
        from runglight.softplc import serve  # noqa: PLC0415

        ended = asyncio.Event()
        with suppress(NotImplementedError):  # Windows knows no handlers; it just ends.
            asyncio.get_running_loop().add_signal_handler(signal.SIGTERM, ended.set)
        async with serve(self._plant, self._options.url, clock) as plc:
            self._announce(plc)
            photographing = self._photograph(plc, clock)
            end_ns = None if lasting_s is None else clock.now_ns() + round(lasting_s * 1e9)
            try:
                with terminal.reporting() as report:
                    while end_ns is None or clock.now_ns() < end_ns:
                        if news := self._news(plc):
                            with report.paused():
                                _say(*news)
                        report.show(self._status(plc))
                        if photographing is not None and photographing.done():
                            photographing.result()
                        left_s = GLANCE_S if end_ns is None else (end_ns - clock.now_ns()) / 1e9
                        with suppress(TimeoutError):
                            await asyncio.wait_for(ended.wait(), max(min(GLANCE_S, left_s), 0))
                        if ended.is_set():
                            return INTERRUPTED
            finally:
                if photographing is not None:
                    photographing.cancel()
                    await asyncio.wait({photographing})
                # Also when interrupted: what was broken is known, and kept.
                _say(*self._news(plc))
                self._conclude(plc)
        return DONE

    def _photograph(self, plc: SoftPlc, clock: SteadyClock) -> asyncio.Task[None] | None:
        camera = self._options.camera
        if camera is None:
            return None
        from runglight.softplc.photographer import keep_photographing  # noqa: PLC0415

        photographing = keep_photographing(plc, camera.folder, clock, camera.interval_ns)
        return asyncio.create_task(photographing)

    def _announce(self, plc: SoftPlc) -> None:
        if self._options.symbols is not None:
            from runglight.plants import write_symbols  # noqa: PLC0415

            write_symbols(plc.symbols, self._options.symbols)
            _say(f"{self._options.symbols}: {counted(len(plc.symbols), 'signal')}")
        _say(f"{self._name}: serving at {plc.url}")
        _say(f"tap it with: {plc.tap_url}")
        for fault, delay_s in self._plan:
            after = f" after {delay_s:g} s" if delay_s else ""
            _say(f"fault {fault.number} {fault.name}: to begin at the next possible moment{after}")
        writable = plc.writable
        if writable:
            _say(f"control it with: runglight simulate program c1 --plant {plc.url}")
        if not plc.url.is_loopback:
            whoever = f"whoever reaches this computer can read {plc.url}"
            terminal.note(
                f"{whoever} and write its outputs" if writable else f"{whoever}; nobody can write"
            )

    def _conclude(self, plc: SoftPlc) -> None:
        _say(f"{self._name}: {self._worked(plc)}")
        if self._options.camera is not None:
            _say(self._options.camera.told)
        file = self._options.labels
        if file is not None:
            from runglight.cli.simulate import labels_json  # noqa: PLC0415

            labels = plc.labels()
            with output(file) as stream:
                stream.write(labels_json(labels))
            _say(f"{file}: {counted(len(labels), 'fault')}")

    def _news(self, plc: SoftPlc) -> list[str]:
        """Brings the plant up to now; what has become of its faults since the last call."""
        labels = plc.labels()
        news = [
            f"{_utc(label.time_ns)} fault {label.number} begins: {label.description}"
            for label in labels[self._begun :]
        ]
        acting = self._plant.acting()
        news += [
            f"fault {fault.number} {fault.name} is over"
            for fault in self._acting
            if fault not in acting
        ]
        self._begun, self._acting = len(labels), acting
        return news

    def _status(self, plc: SoftPlc) -> str:
        faults = ", ".join(f"{fault.number} {fault.name}" for fault in self._acting)
        return (
            f"{self._name}: {counted(plc.clients, 'client')}, {self._worked(plc)}"
            f"{f', broken by {faults}' if faults else ''}"
        )

    def _worked(self, plc: SoftPlc) -> str:
        return f"{counted(self._plant.cycles, 'cycle')}, {counted(plc.change_count, 'change')}"


def _utc(time_ns: int) -> str:
    from datetime import UTC, datetime  # noqa: PLC0415

    time = datetime.fromtimestamp(time_ns // 1_000_000_000, UTC)
    return f"{time:%Y-%m-%dT%H:%M:%S}.{time_ns // 1_000_000 % 1000:03}Z"


def _say(*sentences: str) -> None:
    console = terminal.results()
    for sentence in sentences:
        console.print(Text(sentence), soft_wrap=True)
    # At once, also into a pipe: whoever waits for the address reads it from there.
    console.file.flush()
