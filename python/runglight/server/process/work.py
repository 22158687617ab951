"""The work of opening a process: read, cut into runs, mine, compare. In a thread; says how far."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from runglight.control.guards import LearnedGuards, learn_guards, read_guards
from runglight.errors import InputError, RunglightError
from runglight.log.changelog import read_log_with
from runglight.process.event_log import EventLog, event_log, read_event_log
from runglight.process.mining import mine
from runglight.process.next_activity import load_next
from runglight.process.petri_net import read_net
from runglight.server.process.opened import OpenedProcess, Runs
from runglight.server.process.past import shadowed
from runglight.server.process.variants import variants_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from runglight.configuration import Configuration
    from runglight.log.changelog import Log
    from runglight.server.catalogue import Item

    Say = Callable[[str], None]

MOST_ROWS = 5_000_000
MOST_ACTIVITIES = 1_000
GUARDS_ENDING = ".guards.json"


class Wanted(msgspec.Struct, frozen=True):
    """What shall be mined, or held against a net."""

    source: str
    """Id of a recording or log."""
    reset: str = ""
    """The change that opens a run; empty for an event log with runs of its own."""
    eta: float = 0.0
    epsilon: float = 0.5
    only: list[str] = []
    """Signals that take part; none: all of them."""
    net: str | None = None
    """Id of a net that is there already: nothing is mined then."""


@dataclass(frozen=True, slots=True)
class Sources:
    """What was looked up for it."""

    source: Item
    net: Item | None
    networks: list[Item]
    configuration: Configuration


def read_source(item: Item, configuration: Configuration) -> Log:
    """A recording or log; InputError where it is too long for a page."""
    log = read_log_with(item.path, configuration.log)
    if len(log) > MOST_ROWS:
        raise InputError(
            f"{item.name}: {len(log):,} rows are more than the {MOST_ROWS:,} that the page mines; "
            "use runglight mine, or record a shorter time"
        )
    return log


def runs_of(wanted: Wanted, sources: Sources) -> tuple[EventLog, Log | None]:
    """The runs of a source; InputError where it cannot be cut, or into too many activities."""
    item, configuration = sources.source, sources.configuration
    if not wanted.reset:
        if item.path.suffix.lower() != ".xes":
            raise InputError("choose the change that opens a run first")
        return read_event_log(item.path), None
    log = read_source(item, configuration)
    table = configuration.symbols.table
    runs = event_log(
        log,
        reset=wanted.reset,
        symbols=table,
        naming=configuration.symbols.naming,
        only=wanted.only,
    )
    if not runs.traces:
        raise InputError(
            f"{item.name}: {wanted.reset} was seen, but no run is whole; record for longer, or "
            "choose a change that comes more often"
        )
    if len(runs.activities) > MOST_ACTIVITIES:
        raise InputError(
            f"{item.name}: {len(runs.activities):,} different activities make no net that anybody "
            "reads; counters or measurements take part: choose the signals of one station"
        )
    return runs, log


def opened(wanted: Wanted, sources: Sources, say: Say) -> OpenedProcess:
    """Mines, or reads the net, and holds the runs against it."""
    item = sources.source
    say(f"reading {item.name}")
    runs, log = runs_of(wanted, sources)
    if sources.net is not None:
        process = opened_net(sources.net, sources.networks, sources.configuration, say)
        process.reset = wanted.reset or None
        process.title = f"{item.name} beside {sources.net.name}"
        process.item = None
    else:
        say(f"mining {runs.traces:,} runs of {len(runs):,} events")
        mined = mine(runs, eta=wanted.eta, epsilon=wanted.epsilon)
        say("is the net sound?")
        process = OpenedProcess(
            id="",
            title=item.name,
            net=mined.net,
            soundness=mined.net.soundness(),
            places={},
            reset=wanted.reset or None,
            mined=mined,
            patience_s=sources.configuration.control.patience_s,
        )
        _find_network(process, sources.networks, say)
    process.id = _id_of(wanted)
    say("do the runs follow the net?")
    variants, different = variants_of(runs, process.net)
    process.runs = Runs(
        log=runs,
        source=item.name,
        fitness=process.net.fitness(runs),
        precision=process.net.precision(runs),
        variants=variants,
        different=different,
    )
    if log is not None:
        _learn_controller(process, log, sources.configuration, say)
    return process


def opened_net(
    item: Item, networks: list[Item], configuration: Configuration, say: Say
) -> OpenedProcess:
    """A net of the directory, with the guards and the network that belong to it."""
    say(f"reading {item.name}")
    net = read_net(item.path)
    process = OpenedProcess(
        id=item.id,
        title=item.name,
        net=net,
        soundness=net.soundness(),
        places={},
        patience_s=configuration.control.patience_s,
        item=item,
        read_s=item.path.stat().st_mtime,
    )
    control = configuration.control
    guards = item.path.with_suffix(GUARDS_ENDING)
    if guards.is_file():
        process.guards = read_guards(guards)
    elif control.guards is not None and _is_at(item.path, control.net):
        process.guards = read_guards(Path(control.guards))
    _find_network(process, networks, say)
    _try_controller(process)
    return process


def _is_at(path: Path, configured: str | None) -> bool:
    return configured is not None and Path(configured).exists() and path.samefile(configured)


def _find_network(process: OpenedProcess, networks: list[Item], say: Say) -> None:
    for item in networks:
        say(f"trying {item.name}")
        try:
            process.network = load_next(item.path, process.net, process.title)
        except (RunglightError, OSError):
            # It is of another net, or damaged: what comes next is then not foretold.
            continue
        process.network_name = item.name
        return


def _learn_controller(
    process: OpenedProcess, log: Log, configuration: Configuration, say: Say
) -> None:
    """Guards from the same recording, unless the net has some; then its shadow looks at it all."""
    say("what would the learned controller do?")
    if process.guards is None:
        try:
            learned: LearnedGuards = learn_guards(
                process.net.engine, [log], configuration.control.reaction_s
            )
            process.guards = learned.text
        except RunglightError as error:
            process.no_controller = str(error)
            return
    _try_controller(process)
    if process.no_controller is None:
        process.disagreements = shadowed(process.shadow(), log)


def _try_controller(process: OpenedProcess) -> None:
    try:
        process.shadow()
    except RunglightError as error:
        process.no_controller = str(error)


def _id_of(wanted: Wanted) -> str:
    """The same wish gives the same process: whoever reloads the page finds it again."""
    return "m" + hashlib.blake2b(msgspec.json.encode(wanted), digest_size=6).hexdigest()
