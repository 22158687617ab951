"""`runglight simulate`: the log of a simulated plant, sound or broken."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import msgspec
from cyclopts import App, Parameter
from rich import box
from rich.table import Table
from rich.text import Text

from runglight.cli import terminal
from runglight.cli.counted import counted
from runglight.cli.exit_codes import DONE
from runglight.cli.output import output
from runglight.cli.simulate_faults import simulate_faults
from runglight.cli.simulate_photos import camera_before
from runglight.cli.simulate_program import simulate_program
from runglight.errors import InputError
from runglight.log.changelog import Log
from runglight.nearest import suggestion
from runglight.quantities import duration_s

if TYPE_CHECKING:
    from runglight.plants import FaultLabel, PlantDescription, PlantRun


Part = Literal["all", "learn", "watch"]


def simulate(
    plant: str | None = None,
    /,
    *,
    log: Path | None = None,
    cycles: int | None = None,
    seed: int = 1,
    fault: tuple[str, ...] = (),
    labels: Path | None = None,
    symbols: Path | None = None,
    size: str | None = None,
    part: Part | None = None,
    scenario: str | None = None,
    events: int | None = None,
    photos: Path | None = None,
    photo_interval: str | None = None,
    serve: str | None = None,
    after: tuple[str, ...] = (),
    for_: Annotated[str | None, Parameter(name="--for")] = None,
    list_plants: Annotated[bool, Parameter(name="--list")] = False,
) -> int:
    """Run a simulated plant: write what a logger at its PLC would have seen, or serve it live.

    Parameters
    ----------
    plant: str
        The plant; `--list` names them.
    log: Path
        File to write: `.csv`, `.parquet`, `.xes` or `.vcd`.
    cycles: int
        Cycles to run (default: the plant's own).
    seed: int
        The same seed gives the same log.
    fault: tuple[str, ...]
        A fault by number or name; repeat it for several. `--list` names them.
    labels: Path
        Write what was broken, when, and where it shows, as JSON.
    symbols: Path
        Write the plant's symbol table.
    size: str
        bodyshop: `main`, `a` or `b`, as large as the plants of the PLAT paper, or `tiny`.
    part: Literal["all", "learn", "watch"]
        bodyshop: what to learn from, what to watch after it, or both in one log.
    scenario: str
        tank: `1`, `2` or `3`, program and plant as in the paper.
    events: int
        bodyshop: events of both parts together (default: as many as the paper has).
    photos: Path
        bottling: folder to fill with photos of the machine; `record --camera` takes them.
    photo_interval: str
        Time between two photos (default: `1s`).
    serve: str
        Be the plant's PLC, in real time, until interrupted: `modbus://127.0.0.1:5020` or
        `s7://127.0.0.1:1102`; port 0 takes a free one. Nobody can write to it, but to the tank's
        valves.
    after: tuple[str, ...]
        With `--serve`: when the fault may begin, counted from the start: `60s`, `5m`; one for
        all faults, or one for each.
    for_: str
        With `--serve`: end by itself after this time. tank: how long to run (default: `880s`).
    list_plants: bool
        Name the plants and their faults.

    """
    if list_plants:
        _list(plant)
        return DONE
    if plant is None:
        raise InputError("which plant? runglight simulate --list names them")
    description = _plant(plant)
    camera = camera_before(description, photos, photo_interval)
    if serve is not None:
        from runglight.cli.simulate_serve import ServeOptions, simulate_serve  # noqa: PLC0415

        finite = {"log": log, "cycles": cycles, "size": size, "part": part, "events": events}
        _refuse_beside_serve(finite)
        chosen = None if scenario is None else _scenario(description, scenario)
        options = ServeOptions(
            serve, seed, fault, after, for_, symbols, labels, camera=camera, scenario=chosen
        )
        return simulate_serve(description, options)
    if after or (for_ is not None and not description.scenarios):
        raise InputError(f"{'--after' if after else '--for'} goes with --serve only; leave it out")
    if log is None and labels is None and symbols is None and camera is None:
        raise InputError(
            f"where to? runglight simulate {plant} --log FILE.csv, or --serve "
            "modbus://127.0.0.1:5020"
        )
    own: dict[str, object] = {"cycles": cycles, "fault": fault or None}
    of_sized: dict[str, object] = {"size": size, "part": part, "events": events}
    of_scenarios: dict[str, object] = {"scenario": scenario}
    if description.sizes:
        _refuse(description, own | of_scenarios)
        run = _run(description, of_sized | {"seed": seed})
    elif description.scenarios:
        _refuse(description, own | of_sized)
        chosen = None if scenario is None else _scenario(description, scenario)
        lasting_s = None if for_ is None else duration_s(for_, "--for")
        run = _run(description, {"scenario": chosen, "seed": seed, "lasting_s": lasting_s})
    else:
        _refuse(description, of_sized | of_scenarios)
        seen = {} if camera is None else camera.witnessing
        run = run_plant(description, cycles=cycles, seed=seed, faults=fault, **seen)
    console = terminal.results()
    if camera is not None:
        console.print(Text(camera.told), soft_wrap=True)
    if log is not None:
        rows = log_of(run).write(log)
        console.print(Text(f"{log}: {counted(rows, 'row')} of {plant}"), soft_wrap=True)
    if labels is not None:
        with output(labels) as stream:
            stream.write(labels_json(run.labels))
        console.print(Text(f"{labels}: {counted(len(run.labels), 'fault')}"), soft_wrap=True)
    if symbols is not None:
        with output(symbols) as stream:
            stream.write(symbols_of(description, run))
        known = counted(len(run.symbols or description.symbols), "signal")
        console.print(Text(f"{symbols}: {known}"), soft_wrap=True)
    return DONE


application = App(name="simulate", default_parameter=Parameter(negative="", show_default=False))
application.default(simulate)
application.command(simulate_faults, name="faults")
application.command(simulate_program, name="program")


def run_plant(
    plant: PlantDescription,
    *,
    cycles: int | None,
    seed: int,
    faults: tuple[str, ...],
    **own: object,
) -> PlantRun:
    """Runs a plant; InputError where it has no such fault or cannot run so."""
    return _run(plant, {"seed": seed, "fault": list(faults) or None, "cycles": cycles, **own})


def _run(plant: PlantDescription, arguments: Mapping[str, object]) -> PlantRun:
    given = {name: value for name, value in arguments.items() if value is not None}
    try:
        with terminal.working(f"Simulating {plant.name}"):
            return plant.simulate(**given)
    except ValueError as error:
        raise InputError(f"simulate {plant.name}: {error}") from None


def _refuse(plant: PlantDescription, options: Mapping[str, object]) -> None:
    """InputError for an option that only other plants have."""
    for name, value in options.items():
        if value is not None:
            raise InputError(f"simulate {plant.name}: this plant has no --{name}; leave it out")


def _scenario(plant: PlantDescription, scenario: str) -> str:
    if scenario not in plant.scenarios:
        known = ", ".join(plant.scenarios)
        has = f"it has {known}" if known else "this plant has none; leave --scenario out"
        raise InputError(f"simulate {plant.name}: there is no scenario {scenario!r}; {has}")
    return scenario


def _refuse_beside_serve(options: Mapping[str, object]) -> None:
    """InputError for an option that needs a run with an end."""
    for name, value in options.items():
        if value is not None:
            raise InputError(
                f"--{name} beside --serve: a served plant works without an end and writes no log; "
                f"leave out --{name}, or record what is served"
            )


def log_of(run: PlantRun) -> Log:
    """The change log of a run."""
    return Log.from_columns(run.time_ns, run.signal_index, run.value, run.signals)


def labels_json(labels: Sequence[FaultLabel]) -> str:
    """What was broken, one JSON object each."""
    text = msgspec.json.format(msgspec.json.encode(labels), indent=2)
    return text.decode() + "\n"


def symbols_of(plant: PlantDescription, run: PlantRun | None = None) -> str:
    """The plant's symbol table, or the one of a run that has its own."""
    from runglight.plants import symbols_csv  # noqa: PLC0415

    return symbols_csv((run and run.symbols) or plant.symbols)


def _plant(name: str) -> PlantDescription:
    # Plants need numpy: not before one is asked for.
    from runglight.plants import PLANTS  # noqa: PLC0415

    if name not in PLANTS:
        near = suggestion(name, PLANTS) or f"; there are: {', '.join(PLANTS)}"
        raise InputError(f"there is no simulated plant {name!r}{near}")
    return PLANTS[name]


def _list(name: str | None) -> None:
    from runglight.plants import PLANTS  # noqa: PLC0415

    console = terminal.results()
    for plant in PLANTS.values() if name is None else [_plant(name)]:
        console.print(Text.assemble((plant.name, "bold"), f": {plant.description}"))
        if plant.sizes:
            console.print(f"  --size {', '.join(plant.sizes)}\n", markup=False, highlight=False)
            continue
        if not plant.faults:
            console.print("  no faults; --photos shows it at work\n", markup=False, highlight=False)
            continue
        table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
        table.add_column("Fault", justify="right")
        table.add_column("Name", no_wrap=True)
        table.add_column("Device", no_wrap=True)
        table.add_column("What it does")
        for fault in plant.faults.values():
            table.add_row(
                str(fault.number),
                Text(fault.name),
                Text(f"{fault.group}-{fault.device}"),
                Text(fault.sentence),
            )
        console.print(table)
