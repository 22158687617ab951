"""`runglight control learn`: what a log shows and the net cannot say."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.text import Text

from runglight.cli import terminal
from runglight.cli.counted import counted
from runglight.cli.exit_codes import DONE
from runglight.cli.reader_options import ReaderOptions, read
from runglight.quantities import duration_s


def control_learn(
    logs: tuple[Path, ...] = (),
    /,
    *,
    net: Path,
    to: Annotated[Path, Parameter(name=["--output", "-o"])],
    reaction: str | None = None,
    options: ReaderOptions | None = None,
) -> int:
    """Learn guards from I/O logs: counters that decide where the net cannot, and timers.

    Parameters
    ----------
    logs: tuple[Path, ...]
        Logs of the machine at its normal work; the net was mined from one of them.
    net: Path
        The net, as `runglight mine` writes it (PNML).
    to: Path
        File to write: JSON.
    reaction: str
        A PLC that acts within this time acts at once; longer is a timer (default: `300ms`).

    """
    from runglight import _engine  # noqa: PLC0415
    from runglight.control.guards import learn_guards, said  # noqa: PLC0415

    options = options or ReaderOptions()
    configuration = options.configuration()
    reaction_s = (
        configuration.control.reaction_s if reaction is None else duration_s(reaction, "--reaction")
    )
    sources = options.sources(list(logs), configuration.log, "from what shall guards be learned?")
    mined = _engine.PetriNet.read_pnml(str(net))
    with terminal.working("Learning"):
        learned = learn_guards(
            mined, [read(path, configuration.log) for path in sources], reaction_s
        )
    learned.save(to)
    console = terminal.results()
    labels = {row[0]: row[1] or row[0] for row in mined.transitions()}
    for point in learned.decisions:
        against = point["contradicted"]
        doubt = f" ({against} of {point['seen']} times otherwise)" if against else ""
        console.print(
            Text(f"after {point['after']}: {said(point['choice'], labels)}{doubt}"), soft_wrap=True
        )
    if not learned.decisions:
        console.print(Text("no decision is needed: the net says everything"), soft_wrap=True)
    console.print(
        Text(
            f"{to}: {counted(learned.events, 'event')} in {counted(learned.runs, 'run')}, "
            f"{counted(learned.departures, 'departure')} from the net"
        ),
        soft_wrap=True,
    )
    return DONE
