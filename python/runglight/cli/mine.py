"""`runglight mine`: from a log to the Petri net that the runs of the machine follow."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import msgspec
from cyclopts import Parameter

from runglight.cli import terminal
from runglight.cli.exit_codes import DONE
from runglight.cli.mining_report import print_report
from runglight.cli.output import output as output_to
from runglight.cli.reader_options import ReaderOptions, read
from runglight.configuration import Configuration, Process
from runglight.errors import InputError
from runglight.process.event_log import EventLog, event_log, read_event_log
from runglight.process.mining import mine as mine_log
from runglight.strictly import convert

if TYPE_CHECKING:
    from collections.abc import Sequence


@Parameter(name="*", group="Mining")
@dataclass(frozen=True, kw_only=True)
class MiningOptions:
    """How the log is cut into runs, and how the net is mined: keys of `[process]`."""

    reset: str | None = None
    "The change that opens a run: `%IX0.1=0`; several at one time joined by `&`."
    eta: float | None = None
    "How much of what is rare is filtered out, from 0 to 1 (default: 0, nothing)."
    epsilon: float | None = None
    "Imbalance of two orders from which on they are not concurrent, from 0 to 1 (default: 0.5)."
    keep_partial: bool = False
    "Keep runs that did not begin with the reset or did not end with the next one."
    only: Annotated[tuple[str, ...], Parameter(consume_multiple=False)] = ()
    "Signal that takes part; repeat it, or join with commas (default: all of them)."

    def over(self, file: Process) -> Process:
        """The table of the file with these options laid over it."""
        said = {
            "reset": self.reset,
            "eta": self.eta,
            "epsilon": self.epsilon,
            "keep_partial": self.keep_partial or None,
            "only": [name.strip() for text in self.only for name in text.split(",")] or None,
        }
        changes = {key: value for key, value in said.items() if value is not None}
        return convert(msgspec.to_builtins(file) | changes, Process, "mine")


def mine(
    log: Path | None = None,
    /,
    *,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
    xes: Path | None = None,
    bpmn: Path | None = None,
    svg: Path | None = None,
    mining: MiningOptions | None = None,
    options: ReaderOptions | None = None,
) -> int:
    """Mine the net that the runs of a machine follow.

    An I/O log is cut into runs at the reset, the change by which one sees that a run begins.
    Changes of inputs at one time are one activity, and so are those of outputs. Says whether the
    net is sound, and where it is not; how well the runs follow it; and how much of what it allows
    was seen.

    Parameters
    ----------
    log: Path
        An I/O log (CSV, Parquet, XES, VCD) or a recording, with `--reset`; or an event log with
        traces of its own (XES), without.
    output: Path
        The net, as PNML.
    xes: Path
        The event log, as XES.
    bpmn: Path
        The net as BPMN 2.0.
    svg: Path
        The net as a drawing: the first place green, the last one red, inputs blue, outputs orange.

    """
    options = options or ReaderOptions()
    configuration = options.configuration()
    process = (mining or MiningOptions()).over(configuration.process)
    sources = options.sources(
        [] if log is None else [log], configuration.log, "what shall be mined?"
    )
    events = _event_log(sources, configuration, process)
    with terminal.working("Mining"):
        mined = mine_log(events, eta=process.eta, epsilon=process.epsilon)
        quality = mined.net.quality(events)
    if mined.epsilon != process.epsilon:
        terminal.note(
            f"with epsilon {process.epsilon:g} the net is not sound; "
            f"the best sound one has epsilon {mined.epsilon:g}"
        )
    if output is not None:
        mined.net.write(output)
    if xes is not None:
        events.write(xes)
    if bpmn is not None:
        mined.write_bpmn(bpmn)
    if svg is not None:
        drawing = mined.net.svg()
        with output_to(svg) as stream:
            stream.write(drawing)
    print_report(terminal.results(), events, mined.net, quality)
    return DONE


def _event_log(
    sources: Sequence[Path | str | None], configuration: Configuration, process: Process
) -> EventLog:
    [source] = sources
    if process.reset is None:
        if source is not None and _is_xes(Path(source)):
            with terminal.working(f"Reading {source}"):
                return read_event_log(source)
        raise InputError(
            f"{source or configuration.log.table}: an I/O log has no runs of its own; name the "
            "change that opens one: --reset %IX0.1=0"
        )
    log = read(source, configuration.log)
    return event_log(
        log,
        reset=process.reset,
        symbols=configuration.symbols.table,
        naming=configuration.symbols.naming,
        keep_partial=process.keep_partial,
        only=process.only,
    )


def _is_xes(path: Path) -> bool:
    return path.name.lower().endswith((".xes", ".xes.gz"))
