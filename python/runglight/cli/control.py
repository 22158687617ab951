"""`runglight control`: run the learned controller, run it beside the real one, or export it."""

from __future__ import annotations

import asyncio
import signal
import sys
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import App, Parameter
from rich.text import Text

from runglight.cli import terminal
from runglight.cli.control_learn import control_learn
from runglight.cli.counted import counted
from runglight.cli.exit_codes import DONE, FINDINGS, INTERRUPTED
from runglight.cli.output import output
from runglight.configuration import Control, load_configuration
from runglight.errors import InputError
from runglight.quantities import duration_s

if TYPE_CHECKING:
    from collections.abc import Callable

    from runglight import _engine
    from runglight.control.link import PlantLink
    from runglight.control.loop import ScanLoop


@Parameter(name="*", group="At a plant")
@dataclass(frozen=True, kw_only=True)
class PlantOptions:
    """Where the plant is, and what may be done to it."""

    plant: str | None = None
    "Modbus device that holds its sensors and actuators: `modbus://HOST:502`."
    shadow: bool = False
    "Write nothing; run beside the real controller and report every disagreement."
    allow_writes: bool = False
    "Really write outputs."
    i_know_this_moves_machinery: bool = False
    "Also where the plant is not on this computer."
    safe: str | None = None
    "Outputs of the safe state: `%QX0.0=0,%QX0.1=1`; others are 0 in it."
    interval: str | None = None
    "Time between two scans (default: `100ms`)."
    patience: str | None = None
    "With `--shadow`: how long the real controller may take to act (default: `500ms`)."
    duration: Annotated[str | None, Parameter(name="--for")] = None
    "End after this time: `10m`."


def control(
    net: Path | None = None,
    /,
    *,
    guards: Path | None = None,
    next_: Annotated[Path | None, Parameter(name="--next")] = None,
    st: Path | None = None,
    symbols: Path | None = None,
    format_: Annotated[Literal["table", "jsonl"] | None, Parameter(name="--format")] = None,
    config: Annotated[Path | None, Parameter(name=["--config", "-c"])] = None,
    options: PlantOptions | None = None,
) -> int:
    """Run the controller that was learned from a PLC's inputs and outputs.

    It takes the place of the PLC's program (`--allow-writes`), runs beside it without writing
    anything (`--shadow`), or is written as a program for a PLC (`--st`). Where the plant does what
    the net does not allow, it goes to the safe state and ends with code 1.

    Parameters
    ----------
    net: Path
        The net, as `runglight mine` writes it (PNML).
    guards: Path
        Counters and timers that decide where the net cannot: `runglight control learn`.
    next_: Path
        Network that decides where the net cannot: `runglight predict train`.
    st: Path
        Write the controller as IEC 61131-3 Structured Text instead of running it.
    symbols: Path
        Symbol table, where the net calls signals by name: it tells their addresses.
    format_: Literal["table", "jsonl"]
        Findings as sentences, or as JSON lines.
    config: Path
        Configuration file (default: `runglight.toml`, if there is one).

    """
    options = options or PlantOptions()
    configuration = load_configuration(config)
    settings = configuration.control
    table = _file(symbols, configuration.symbols.table)
    # The engine: not before it is needed.
    from runglight import _engine  # noqa: PLC0415
    from runglight.control.guards import read_guards  # noqa: PLC0415

    net_file = _file(net, settings.net)
    if net_file is None:
        raise InputError("which net? runglight control NET.pnml --plant URL")
    guards_file = _file(guards, settings.guards)
    next_file = _file(next_, settings.next)
    mined = _engine.PetriNet.read_pnml(str(net_file))
    guards_text = None if guards_file is None else read_guards(guards_file)
    safe = _safe(options.safe, settings)
    if st is not None:
        return _export(mined, guards_text, safe, st, next_file)
    plant = options.plant or settings.plant
    if plant is None:
        raise InputError("at which plant? add --plant modbus://HOST:502, or --st FILE.st")
    if options.shadow and options.allow_writes:
        raise InputError("--shadow writes nothing: leave out --allow-writes")
    network = None if next_file is None else _engine.load_next(str(next_file), mined, str(net_file))
    interval = options.interval or settings.interval
    interval_ns = round(duration_s(interval, "--interval") * 1e9)
    if interval_ns <= 0:
        raise InputError("--interval: must be above zero; a PLC scans every 10ms to 100ms")
    lasting = options.duration or settings.duration
    run = _Run(
        lasting_ns=None if lasting is None else round(duration_s(lasting, "--for") * 1e9),
        interval_ns=interval_ns,
        tell=_teller(format_ or settings.format),
        addresses=_addresses(table, configuration.symbols.naming),
    )
    if options.shadow:
        patience_s = (
            settings.patience_s
            if options.patience is None
            else duration_s(options.patience, "--patience")
        )
        shadow = _engine.Shadow(mined, guards_text, network, patience_s)
        return run.beside(shadow, plant)
    controller = _engine.Controller(mined, guards_text, network, safe)
    return run.in_control(controller, plant, options)


application = App(name="control", default_parameter=Parameter(negative="", show_default=False))
application.default(control)
application.command(control_learn, name="learn")


def _export(
    net: _engine.PetriNet,
    guards: str | None,
    safe: list[tuple[str, int]],
    st: Path,
    next_file: Path | None,
) -> int:
    from runglight import _engine  # noqa: PLC0415

    if next_file is not None:
        terminal.note(
            f"{next_file}: a network cannot be written as Structured Text; guards decide in {st}"
        )
    text = _engine.structured_text_of(net, guards, safe, st.stem)
    with output(st) as stream:
        stream.write(text)
    terminal.results().print(
        Text(f"{st}: {counted(len(text.splitlines()), 'line')}"), soft_wrap=True
    )
    return DONE


@dataclass(frozen=True, slots=True)
class _Run:
    """One time at a plant."""

    lasting_ns: int | None
    interval_ns: int
    tell: Callable[[list[str]], None]
    addresses: dict[str, str]

    def beside(self, shadow: _engine.Shadow, plant: str) -> int:
        from runglight.control.steppers import Beside  # noqa: PLC0415

        found: list[str] = []

        def tell(lines: list[str]) -> None:
            found.extend(lines)
            self.tell(lines)

        link = self._link(shadow.terminals, plant)
        terminal.note(f"{link.url}: nothing is written")
        loop, code = self._scan(link, Beside(shadow, tell), None)
        terminal.note(
            f"{counted(loop.scans, 'scan')}, {counted(len(found), 'disagreement')}"
            + ("" if shadow.following else "; it does not know where the plant stands")
        )
        return FINDINGS if found and code == DONE else code

    def in_control(self, controller: _engine.Controller, plant: str, options: PlantOptions) -> int:
        from runglight.control.permission import check_permission  # noqa: PLC0415
        from runglight.control.steppers import InControl  # noqa: PLC0415

        link = self._link(controller.terminals, plant)
        check_permission(
            link.url,
            link.host,
            allow_writes=options.allow_writes,
            moves_machinery=options.i_know_this_moves_machinery,
        )
        terminal.note(f"{link.url}: will write {', '.join(link.output_places())}")
        terminal.note(f"safe state, also at the end: {link.spelled(controller.safe)}")
        stepper = InControl(controller, self.tell)
        loop, code = self._scan(link, stepper, lambda: stepper.gave_up)
        terminal.note(f"{counted(loop.scans, 'scan')}, {counted(stepper.writes, 'write')}")
        return FINDINGS if stepper.gave_up else code

    def _link(self, rows: list[tuple[str, str]], plant: str) -> PlantLink:
        from runglight.control.link import PlantLink  # noqa: PLC0415
        from runglight.control.terminals import Terminals  # noqa: PLC0415

        return PlantLink(plant, Terminals.of(rows), self.addresses)

    def _scan(
        self, link: PlantLink, stepper: object, over: Callable[[], bool] | None
    ) -> tuple[ScanLoop, int]:
        from runglight.control.loop import ScanLoop  # noqa: PLC0415
        from runglight.taps.clock import SteadyClock  # noqa: PLC0415
        from runglight.taps.grid import Grid  # noqa: PLC0415

        clock = SteadyClock()
        loop = ScanLoop(link, clock, Grid(self.interval_ns), stepper)  # type: ignore[arg-type]
        until_ns = None if self.lasting_ns is None else clock.now_ns() + self.lasting_ns

        def glance() -> None:
            if over is not None and over():
                loop.stop()

        return loop, run_until_ended(loop, until_ns, glance)


def run_until_ended(
    loop: ScanLoop, until_ns: int | None, glance: Callable[[], None] | None = None
) -> int:
    """Scans until the time is over (0) or somebody ends it (130); the farewell is written."""
    interrupted = False

    async def scan() -> None:
        def stop() -> None:
            nonlocal interrupted
            interrupted = True
            loop.stop()

        for number in (signal.SIGINT, signal.SIGTERM):
            with suppress(NotImplementedError):  # Windows knows no handlers; it just ends.
                asyncio.get_running_loop().add_signal_handler(number, stop)
        await loop.run(until_ns, glance)

    asyncio.run(scan())
    return INTERRUPTED if interrupted else DONE


def _teller(format_: Literal["table", "jsonl"]) -> Callable[[list[str]], None]:
    from runglight.cli.live_printing import JsonLines, People  # noqa: PLC0415

    told = JsonLines(sys.stdout) if format_ == "jsonl" else People(sys.stdout, notices=True)
    told.begin()
    return told.tell


def _file(said: Path | None, configured: str | None) -> Path | None:
    return said if said is not None or configured is None else Path(configured)


def _safe(text: str | None, settings: Control) -> list[tuple[str, int]]:
    if text is None:
        return list(settings.safe.items())
    safe: list[tuple[str, int]] = []
    for part in text.split(","):
        address, separator, value = (piece.strip() for piece in part.rpartition("="))
        if not separator or not address or not value.lstrip("-").isdecimal():
            raise InputError(f"--safe: {part.strip()!r} is no output and value; write %QX0.0=0")
        safe.append((address, int(value)))
    return safe


def _addresses(symbols: Path | None, naming: str) -> dict[str, str]:
    if symbols is None:
        return {}
    from runglight.control.symbol_addresses import symbol_addresses  # noqa: PLC0415

    return symbol_addresses(symbols, naming)
