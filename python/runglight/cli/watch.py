"""`runglight watch`: what departs from the nominal model."""

from __future__ import annotations

import sqlite3
import time
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, TextIO

import msgspec
from cyclopts import Parameter

from runglight.cli import terminal
from runglight.cli.exit_codes import DONE, FINDINGS
from runglight.cli.finding_table import print_findings, summary_line
from runglight.cli.live_options import LiveOptions
from runglight.cli.next_options import NextOptions
from runglight.cli.output import output as output_to
from runglight.cli.reader_options import ReaderOptions, read
from runglight.errors import InputError
from runglight.findings import flat
from runglight.findings.finding import Finding, decode_finding
from runglight.findings.store import FindingStore
from runglight.findings.tally import Tally
from runglight.live.signal_names import names_in_model
from runglight.model import ROWS_AT_ONCE, load_model
from runglight.replacing import replacing
from runglight.taps import is_live

if TYPE_CHECKING:
    from collections.abc import Iterator

    from runglight.configuration import Configuration, Watch
    from runglight.findings.batch import Told
    from runglight.log.changelog import Log
    from runglight.model import NominalModel
    from runglight.process.next_activity import NextMonitor

_LINES_AT_ONCE = 128
"""Lines written by one call: enough that calls do not count, few enough for memory in reach."""
NEXT_STATE = ".next"
"""Ending of the file beside `--state` that keeps where the network stands."""


def watch(
    model: Path,
    source: str | None = None,
    /,
    *,
    format: Literal["table", "jsonl", "csv"] | None = None,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
    fail_on: Literal["fault", "anomaly"] | None = None,
    notices: bool | None = None,
    state: Path | None = None,
    options: ReaderOptions | None = None,
    live: LiveOptions | None = None,
    foretelling: NextOptions | None = None,
) -> int:
    """Say what departs from the nominal model: where, when, and what should have happened.

    A live address is watched until Ctrl-C (or `--for`), and findings are told as they come.
    Findings are kept in the model directory, so that `runglight confirm` finds them.

    Parameters
    ----------
    model: Path
        Model directory written by `runglight learn`.
    source: str
        The log or the live address to watch: `modbus://plc?inputs=0-63`, `replay:FILE?speed=10`
        (default: what `--sql` names, else `[source] url` of the configuration).
    format: str
        `table` for people (default), `jsonl` for programs, `csv` for spreadsheets.
    output: Path
        File to write instead of standard output. Live findings are added to it as they come.
    fail_on: str
        Exit with code 1 where there is a fault (`anomaly`: a fault or an anomaly).
    notices: bool
        Show notices in the table too.
    state: Path
        Go on where the last log ended, and keep the state for the next one. The last scan stays
        open until then. Live, it is kept every ten seconds, and a gap stands between two starts.

    """
    options = options or ReaderOptions()
    live = live or LiveOptions()
    configuration = options.configuration()
    live.over(configuration)
    settings = configuration.watch = _laid_over(
        configuration.watch,
        format=format,
        output=output,
        fail_on=fail_on,
        notices=notices,
        state=state,
    )
    if source is None and options.sql is None and options.table is None:
        source = configuration.source.url
    [only] = options.sources(
        [] if source is None else [source], configuration.log, "what shall be watched?"
    )
    nominal = load_model(model)
    if source is not None and is_live(source):
        if foretelling not in {None, NextOptions()}:
            raise InputError(f"--next: is for logs, and {source} is a live source; record it first")
        from runglight.cli.watch_live import watch_live  # noqa: PLC0415

        return watch_live(model, nominal, source, configuration)
    if (option := live.first_said()) is not None:
        raise InputError(f"{option}: is for live sources, and {source or 'a table'} is a log")
    kept = None if settings.state is None else Path(f"{settings.state}{NEXT_STATE}")
    foreteller = (foretelling or NextOptions()).monitor(kept)
    as_read = read(only, configuration.log, to_its_end=True)
    log = _named(as_read, nominal, configuration)

    started = time.perf_counter()
    telling = _Telling(settings)
    with (
        output_to(settings.output, keep_when_interrupted=settings.format != "table") as stream,
        ExitStack() as stack,
    ):
        store = _store(model, stack)
        telling.begin(stream)
        for told in _watched(nominal, log, settings, store):
            telling.tell(told, stream)
        if foreteller is not None:
            for told in _foretold(foreteller, as_read, kept, store):
                telling.tell(told, stream)
        seconds = time.perf_counter() - started
        telling.end(stream, len(log), seconds)
    return FINDINGS if telling.met else DONE


class _Telling:
    """Writes findings as they come, and remembers what the end needs."""

    def __init__(self, settings: Watch) -> None:
        self._settings = settings
        self._findings: list[Finding] = []
        self._tally = Tally()
        self._alarming: set[str] = {
            None: set(),
            "fault": {"fault"},
            "anomaly": {"fault", "anomaly"},
        }[settings.fail_on]
        self.met = False

    def begin(self, stream: TextIO) -> None:
        if self._settings.format == "csv":
            stream.write(flat.header())

    def tell(self, told: Told, stream: TextIO) -> None:
        self._tally.add(told.ids, told.kinds, told.severities)
        self.met = self.met or not self._alarming.isdisjoint(told.severities)
        if self._settings.format == "jsonl":
            for start in range(0, len(told.lines), _LINES_AT_ONCE):
                stream.write("\n".join([*told.lines[start : start + _LINES_AT_ONCE], ""]))
        elif self._settings.format == "csv":
            stream.writelines(map(flat.row, told.lines))
        else:
            self._findings += map(decode_finding, told.lines)

    def end(self, stream: TextIO, events: int, seconds: float) -> None:
        line = summary_line(self._tally, events, seconds)
        if self._settings.format != "table":
            terminal.note(line)
            return
        console = terminal.console_for(stream)
        print_findings(console, self._findings, notices=self._settings.notices)
        console.print(line, markup=False, soft_wrap=True)


def _watched(
    model: NominalModel, log: Log, settings: Watch, store: FindingStore | None
) -> Iterator[Told]:
    monitor = model.monitor(_restored(settings.state))
    with terminal.progressing("Watching", len(log)) as advance:
        for offset in range(0, len(log), ROWS_AT_ONCE):
            found = monitor.observe_slice(log, offset, ROWS_AT_ONCE)
            yield _kept(found.told(), monitor.take_snapshots(), store)
            advance(min(ROWS_AT_ONCE, len(log) - offset))
    if settings.state is None:
        yield _kept(monitor.finish().told(), monitor.take_snapshots(), store)
    else:
        with replacing(Path(settings.state)) as temporary:
            temporary.write_bytes(monitor.state())


def _foretold(
    monitor: NextMonitor, log: Log, state: Path | None, store: FindingStore | None
) -> Iterator[Told]:
    yield _kept(monitor.observe(log).told(), [], store)
    if state is None:
        yield _kept(monitor.finish().told(), [], store)
    else:
        with replacing(state) as temporary:
            temporary.write_bytes(monitor.state())


def _kept(told: Told, snapshots: list[str], store: FindingStore | None) -> Told:
    if store is not None and (told.lines or snapshots):
        store.append(told.lines, snapshots, ids=told.ids)
    return told


def _restored(state: str | None) -> bytes | None:
    if state is None or not Path(state).exists():
        return None
    return Path(state).read_bytes()


def _store(model: Path, stack: ExitStack) -> FindingStore | None:
    try:
        return stack.enter_context(FindingStore(model))
    except sqlite3.Error as error:
        terminal.note(
            f"{model}: findings cannot be kept here ({error}), so runglight confirm will not know "
            "them; make the directory writable"
        )
        return None


def _named(log: Log, model: NominalModel, configuration: Configuration) -> Log:
    """The log with its signals called as the model calls them, where a symbol table tells."""
    if model.knows(log):
        return log
    signals = log.signals
    name_of = names_in_model(model, configuration.symbols)
    taken = set(signals)
    # A name that the log has already is another signal's.
    names = [
        name if (name := name_of(signal, signal)) not in taken else signal for signal in signals
    ]
    return log if names == signals else log.renamed(names)


def _laid_over(file: Watch, **said: object) -> Watch:
    changes = {
        key: str(value) if isinstance(value, Path) else value
        for key, value in said.items()
        if value is not None
    }
    return msgspec.structs.replace(file, **changes)
