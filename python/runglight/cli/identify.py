"""`runglight identify`: the address that declared events mean."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import msgspec
from cyclopts import Parameter

from runglight.cli import terminal
from runglight.cli.exit_codes import DONE
from runglight.cli.identify_accept import accept_address
from runglight.cli.identify_propose import propose_to
from runglight.cli.identify_table import (
    as_csv,
    as_json,
    print_agreement,
    print_found,
    print_sweep,
)
from runglight.cli.output import output as output_to
from runglight.cli.reader_options import ReaderOptions, read
from runglight.configuration import Configuration
from runglight.configuration import Identify as Settings
from runglight.errors import InputError
from runglight.identification.events import Events, read_events
from runglight.identification.identify import identify_in
from runglight.identification.subject import Subject, of_recording
from runglight.identification.sweep import Sweep, sweep_in
from runglight.log.symbols import names_by_address, read_symbols
from runglight.quantities import duration_s
from runglight.recording.layout import EVENTS, is_recording

if TYPE_CHECKING:
    from runglight.log.options import ReadOptions

SWEEP = "sweep"


@Parameter(name="*", group="Events")
@dataclass(frozen=True, kw_only=True)
class EventOptions:
    """What was declared, and how far changes may lie from it."""

    events: Path | None = None
    "Declared events: a column `time`, optional `label` (default: those in the recording)."
    label: str | None = None
    "Which events, where the file holds several kinds; `any` for all."
    tau: str | None = None
    "A change lies at most this far from its event (default: `4s`); `sweep` finds out."
    view: Literal["all", "rising", "falling", "increments"] | None = None
    "Which changes count: all (default), one kind of edge, or a counter's increments."
    share: float | None = None
    "Share of the changing signals that is kept (default: 0.2, the best fifth)."
    words: tuple[str, ...] = ()
    "Signal that is a word although only 0 and 1 were seen of it; repeat it, or join with commas."
    order: Literal["scores", "agreement"] | None = None
    "By the scores (default), or by how well changes fit events one by one at one lag."
    propose: str | None = None
    "`X,Y,WIDTH,HEIGHT`: take the events from the photos, where this rectangle changes."
    propose_by: Literal["look", "motion"] = "look"
    "An event is a change of `look` (something comes or goes), or of `motion` (starts or stops)."


@Parameter(name="*", group="Result")
@dataclass(frozen=True, kw_only=True)
class ResultOptions:
    """What becomes of the result."""

    rows: int | None = None
    "Rows of the table (default: 20); other formats have all."
    accept: str | None = None
    "Address to write into the symbol table, as the table shows it; asks for `--name`."
    name: str | None = None
    "Name of the accepted address: `Line1-Conveyor-Running`."


def identify(
    source: Path | None = None,
    /,
    *,
    format: Literal["table", "csv", "json"] | None = None,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
    declared: EventOptions | None = None,
    result: ResultOptions | None = None,
    options: ReaderOptions | None = None,
) -> int:
    """Find the address that declared events mean.

    Look at the machine, or at the photos of its recording, and write down when something
    happened. The signal that means it changes near every event (score in) and at no other time
    (score out): 0 is best for both. Words are searched bit by bit too.

    Parameters
    ----------
    source: Path
        Recording or log to search (default: `[record] to` of the configuration).
    format: str
        Default: by the ending of the output file, else `table`.
    output: Path
        File to write instead of standard output. With `--propose`: the events
        (default: `events.csv` of the recording).

    """
    declared, result = declared or EventOptions(), result or ResultOptions()
    options = options or ReaderOptions()
    configuration = options.configuration()
    settings = _laid_over(configuration.identify, declared, result, format or _by_ending(output))
    place = _place(source, options, configuration)
    if declared.propose is not None:
        if place is None or not is_recording(place):
            raise InputError(f"--propose: {place or 'a table'} is no recording, so has no photos")
        return propose_to(place, declared.propose, declared.propose_by, output)
    tau_s = None if settings.tau == SWEEP else duration_s(settings.tau, "--tau")
    subject = _subject(place, configuration)
    if result.accept is not None or result.name is not None:
        accept_address(subject, result.accept, result.name, configuration.symbols)
        if settings.events is None:
            return DONE
    events = _events(place, settings, configuration.log, subject)
    sweep = None
    if tau_s is None:
        with terminal.working("Trying several tau"):
            sweep = sweep_in(subject, events, view=settings.view, words=settings.words)
        tau_s = sweep.tau_s
    _tell(subject, events, sweep, tau_s, settings, output)
    return DONE


def _tell(  # noqa: PLR0917
    subject: Subject,
    events: Events,
    sweep: Sweep | None,
    tau_s: float,
    settings: Settings,
    output: Path | None,
) -> None:
    with terminal.working("Identifying"):
        found = identify_in(
            subject,
            events,
            tau_s=tau_s,
            view=settings.view,
            share=settings.share,
            words=settings.words,
            order=settings.order,
        )
    if (lost := len(found.unrecorded_ns)) > 0:
        were = "event lies" if lost == 1 else "events lie"
        terminal.note(f"{lost:,} {were} where nothing was recorded: left out")
    if sweep is not None and settings.format == "csv":
        terminal.note(sweep.reason())
    with output_to(output) as stream:
        if settings.format == "csv":
            stream.write(as_csv(found))
        elif settings.format == "json":
            stream.write(as_json(found, settings.view, sweep))
        else:
            console = terminal.console_for(stream)
            if sweep is not None:
                print_sweep(console, sweep)
            print_found(console, found, events, settings.rows)
            if settings.order == "scores":
                print_agreement(console, found, found.agreed(events, subject.log.scan_interval_s))


def _laid_over(
    file: Settings, declared: EventOptions, result: ResultOptions, format: str | None
) -> Settings:
    words = [part.strip() for text in declared.words for part in text.split(",") if part.strip()]
    said = {
        "events": None if declared.events is None else str(declared.events),
        "label": declared.label,
        "tau": declared.tau,
        "view": declared.view,
        "share": declared.share,
        "words": words or None,
        "order": declared.order,
        "rows": result.rows,
        "format": format,
    }
    if declared.share is not None and not 0 < declared.share <= 1:
        raise InputError(f"--share: {declared.share:g} must be more than 0 and at most 1")
    if result.rows is not None and result.rows < 1:
        raise InputError(f"--rows: {result.rows} must be at least 1")
    changes = {key: value for key, value in said.items() if value is not None}
    return msgspec.structs.replace(file, **changes)


def _by_ending(output: Path | None) -> str | None:
    return None if output is None else {".csv": "csv", ".json": "json"}.get(output.suffix.lower())


def _place(
    source: Path | None, options: ReaderOptions, configuration: Configuration
) -> Path | None:
    """The log or recording; None for a table of a database."""
    if source is None and options.sql is None and configuration.record.to is not None:
        source = Path(configuration.record.to)
    named = [] if source is None else [source]
    [only] = options.sources(named, configuration.log, "what shall be searched?")
    return None if only is None else Path(only)


def _subject(place: Path | None, configuration: Configuration) -> Subject:
    symbols = configuration.symbols
    names: dict[str, str] = {}
    if symbols.table is not None and Path(symbols.table).exists():
        names = names_by_address(read_symbols(Path(symbols.table)), symbols.naming)
    if place is not None and is_recording(place):
        with terminal.working(f"Reading {place}"):
            subject = of_recording(place, names)
        for sentence in subject.log.report.sentences(str(place)):
            terminal.note(sentence)
        return subject
    return Subject(read(place, configuration.log), names=names)


def _events(
    place: Path | None, settings: Settings, options: ReadOptions, subject: Subject
) -> Events:
    path = settings.events
    if path is None and place is not None and is_recording(place) and (place / EVENTS).is_file():
        path = str(place / EVENTS)
    if path is None:
        raise InputError(
            "which events? declare them in a CSV file with a column 'time' and name it with "
            "--events, or take them from photos with --propose"
        )
    start = subject.log.start
    # Times of day are those of the log's first day.
    date = options.date or (None if start is None else start.date().isoformat())
    events = read_events(path, date=date)
    for sentence in events.report.sentences(path):
        if "give date for the real one" not in sentence:
            terminal.note(sentence)
    return events.labelled(settings.label, path)
