"""`runglight simulate program`: a PLC program at a served plant, in a process of its own."""

from __future__ import annotations

from typing import Annotated

from cyclopts import Parameter

from runglight.cli import terminal
from runglight.cli.counted import counted
from runglight.errors import InputError
from runglight.nearest import suggestion
from runglight.quantities import duration_s


def simulate_program(
    program: str,
    /,
    *,
    plant: str,
    interval: str = "100ms",
    for_: Annotated[str | None, Parameter(name="--for")] = None,
) -> int:
    """Run a program of the simulated tank at a tank that is served elsewhere.

    It reads the sensors and writes the valves over Modbus, as `runglight control` does: the two
    can be swapped.

    Parameters
    ----------
    program: str
        `c1` fills and empties; `c2` swings three times before it empties.
    plant: str
        The tank: `modbus://127.0.0.1:5020`, as `runglight simulate tank --serve` says it.
    interval: str
        Time between two scans.
    for_: str
        End after this time: `10m`.

    """
    from runglight.cli.control import run_until_ended  # noqa: PLC0415
    from runglight.control.permission import is_loopback  # noqa: PLC0415
    from runglight.plants.tank import PROGRAMS, SYMBOLS  # noqa: PLC0415
    from runglight.plants.tank.ladder import LadderProgram  # noqa: PLC0415
    from runglight.softplc.remote_program import remote_program  # noqa: PLC0415
    from runglight.taps.clock import SteadyClock  # noqa: PLC0415
    from runglight.taps.grid import Grid  # noqa: PLC0415
    from runglight.taps.url import parse_source  # noqa: PLC0415

    if program not in PROGRAMS:
        near = suggestion(program, PROGRAMS) or f"; there are: {', '.join(PROGRAMS)}"
        raise InputError(f"there is no program {program!r}{near}")
    if not is_loopback(parse_source(plant).host):
        raise InputError(
            f"{plant}: a simulated program writes to this computer alone; "
            "runglight control writes elsewhere"
        )
    interval_ns = round(duration_s(interval, "--interval") * 1e9)
    lasting_ns = None if for_ is None else round(duration_s(for_, "--for") * 1e9)
    clock = SteadyClock()
    loop = remote_program(
        LadderProgram(PROGRAMS[program]),
        SYMBOLS,
        plant,
        clock=clock,
        grid=Grid(max(interval_ns, 1)),
    )
    until_ns = None if lasting_ns is None else clock.now_ns() + lasting_ns
    code = run_until_ended(loop, until_ns)
    terminal.note(f"{program}: {counted(loop.scans, 'scan')}")
    return code
