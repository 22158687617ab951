"""`identify`: signals ranked by how well their changes fit declared events."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import msgspec

from runglight import _engine
from runglight.errors import InputError
from runglight.identification.events import Events, read_events
from runglight.identification.subject import DEFAULT_NAMING, Subject, subject_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from datetime import datetime
    from os import PathLike

    import numpy as np
    import numpy.typing as npt

    from runglight.log.changelog import Log

View = Literal["all", "rising", "falling", "increments"]
Order = Literal["scores", "agreement"]


class Candidate(msgspec.Struct, frozen=True):
    """A signal, or a bit of a word, and how well it fits."""

    rank: int
    """1 for the best; equal scores have the same rank."""
    address: str
    """Address or name, as the log has it; a bit as its PLC writes it: `%MW74.0`."""
    name: str | None
    """Its name in the symbol table."""
    score_in: float
    """Mean over the windows of 1 - min(e, c) / max(e, c), for e events and c changes; 0 is best."""
    score_out: float
    """Mean over the areas outside of changes per second; 0 is best."""
    changes: int
    """Number of changes that count."""
    same_as: str
    """The first of the list that changes at exactly the same moments; itself, where it is that."""
    agreement: float | None = None
    """Of events and changes matched one by one, 1 is best; None in the order of the scores."""


class Window(msgspec.Struct, frozen=True):
    """A window around one event, or around several whose windows overlap."""

    start_ns: int
    end_ns: int
    events: int


class _Summary(msgspec.Struct):
    start_ns: int
    end_ns: int
    windows: list[Window]
    areas_s: list[float]
    unrecorded_ns: list[int]
    changing: int


class Identification:
    """The best candidates, best first.

    Like a list of `Candidate`, and an Arrow table of the same columns: `polars.DataFrame(found)`.
    The table is always in the order of the scores, and without `agreement`.
    """

    def __init__(
        self, engine_found: _engine.Identification, engine_log: _engine.ChangeLog, tau_s: float
    ) -> None:
        self._engine = engine_found
        self._log = engine_log
        self._summary = msgspec.json.decode(engine_found.summary_json(), type=_Summary)
        self._rows: list[Candidate] | None = None
        self._places: list[int] | None = None
        self.tau_s = tau_s

    def __len__(self) -> int:
        return len(self._engine)

    def __getitem__(self, place: int) -> Candidate:
        return self._candidates()[place]

    def __iter__(self) -> Iterator[Candidate]:
        return iter(self._candidates())

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        return self._engine.__arrow_c_stream__(requested_schema)

    def __repr__(self) -> str:
        first = f", first {self[0].address}" if len(self) else ""
        return f"<runglight.Identification of {len(self):,} candidates{first}>"

    def first(self) -> list[Candidate]:
        """All that are ranked first: one, or several this log cannot tell apart."""
        return [each for each in self.best(len(self)) if each.rank == 1]

    def best(self, limit: int) -> list[Candidate]:
        """The first `limit` candidates."""
        if self._rows is not None:
            return self._rows[:limit]
        return msgspec.json.decode(self._engine.rows_json(limit), type=list[Candidate])

    def copies(self, candidate: Candidate) -> list[str]:
        """Addresses of the others that change at exactly the same moments."""
        return [
            other.address
            for other in self
            if other.same_as == candidate.same_as and other.address != candidate.address
        ]

    def moments(self, limit: int) -> list[npt.NDArray[np.int64]]:
        """When the first `limit` candidates changed, in nanoseconds since 1970."""
        if self._places is None:
            return self._engine.moments(self._log, limit)
        places = self._places[:limit]
        moments = self._engine.moments(self._log, max(places, default=-1) + 1)
        return [moments[place] for place in places]

    def agreed(self, events: Events, scan_interval_s: float | None) -> Identification:
        """The same candidates, those first whose changes agree best with events one by one."""
        from runglight.identification.agreement import MOST, by_agreement  # noqa: PLC0415

        found = Identification(self._engine, self._log, self.tau_s)
        found._rows, found._places = by_agreement(
            self.best(len(self)),
            self.moments(MOST),
            events.time_ns,
            round(self.tau_s * 1e9),
            round((scan_interval_s or 0.0) * 1e9),
        )
        return found

    @property
    def windows(self) -> list[Window]:
        """The windows around the events, in time order."""
        return self._summary.windows

    @property
    def areas_s(self) -> list[float]:
        """Recorded width of each area outside of the windows, in seconds."""
        return self._summary.areas_s

    @property
    def unrecorded_ns(self) -> list[int]:
        """Events that count for nothing, because nothing was recorded when they happened."""
        return self._summary.unrecorded_ns

    @property
    def recorded_ns(self) -> tuple[int, int]:
        """First and last recorded time, nanoseconds since 1970."""
        return self._summary.start_ns, self._summary.end_ns

    @property
    def changing(self) -> int:
        """Number of candidates that change at all; the best share of them is in the list."""
        return self._summary.changing

    def _candidates(self) -> list[Candidate]:
        if self._rows is None:
            self._rows = msgspec.json.decode(self._engine.rows_json(), type=list[Candidate])
        return self._rows


def identify(
    log: Log | Any,
    events: Events | str | PathLike[str] | Iterable[datetime | int] | npt.NDArray[np.int64],
    *,
    tau_s: float = 4.0,
    view: View = "all",
    share: float = 0.2,
    words: Sequence[str] = (),
    order: Order = "scores",
    label: str | None = None,
    symbols: str | PathLike[str] | None = None,
    naming: str = DEFAULT_NAMING,
) -> Identification:
    """Ranks the signals of a log, and the bits of its words, by declared events.

    `log` is a `Log`, an Arrow table, or the path of a log or a recording; of a recording the
    addresses and types are known. `events` are the path of an `events.csv` (`label` picks one
    kind), or aware datetimes, or nanoseconds since 1970.

    A change is expected at most `tau_s` seconds before or after its event. `view` says which
    changes count: all, rising or falling edges, or increments of counters. The best `share` of
    the candidates that change is given. `words` names signals that are words although only 0 and
    1 were seen of them. In the order `agreement` the candidates are those that the scores select,
    but those come first whose changes fit the events one by one, all at nearly the same lag: of
    events in groups, or where some were missed, it is the better one.
    `symbols` is the path of a symbol table that names addresses.

    Raises InputError where no event lies in recorded time.
    """
    subject = subject_of(log, symbols=symbols, naming=naming)
    return identify_in(
        subject,
        events_of(events, label),
        tau_s=tau_s,
        view=view,
        share=share,
        words=words,
        order=order,
    )


def identify_in(
    subject: Subject,
    events: Events,
    *,
    tau_s: float,
    view: View = "all",
    share: float = 0.2,
    words: Sequence[str] = (),
    order: Order = "scores",
) -> Identification:
    """As `identify`, with what is searched and the events read before."""
    settings = settings_json(tau_s=tau_s, view=view, share=share, words=(*subject.words, *words))
    log = subject.log.engine
    found = _engine.identify(log, events.time_ns, settings, dict(subject.names))
    by_scores = Identification(found, log, tau_s)
    if order == "scores":
        return by_scores
    return by_scores.agreed(events, subject.log.scan_interval_s)


def settings_json(*, tau_s: float, view: View, share: float, words: Sequence[str]) -> str:
    """The settings as the engine takes them."""
    settings = {"tau_ns": round(tau_s * 1e9), "view": view, "share": share, "words": list(words)}
    return msgspec.json.encode(settings).decode()


def events_of(events: Any, label: str | None = None, *, date: str | None = None) -> Events:
    """Events from what a caller may give."""
    if isinstance(events, Events):
        return events.labelled(label)
    if isinstance(events, str) or hasattr(events, "__fspath__"):
        return read_events(events, date=date).labelled(label, str(events))
    if label is not None:
        raise InputError("identify: label picks among the rows of an events.csv; give its path")
    return Events.of(events)
