"""Which τ? Every one of a list is tried, and the one suggested at which the best meets most."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

from runglight import _engine
from runglight.errors import InputError
from runglight.identification.identify import View, events_of, settings_json
from runglight.identification.subject import DEFAULT_NAMING, Subject, subject_of

if TYPE_CHECKING:
    from collections.abc import Sequence
    from os import PathLike

    from runglight.identification.events import Events
    from runglight.log.changelog import Log

TAUS_S = (0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0, 10.0, 15.0, 20.0, 30.0)
"""What is tried: seconds."""
GOOD = 0.9
"""What meets this share of the most is as good."""


class Contender(msgspec.Struct, frozen=True):
    """A signal at one τ."""

    address: str
    score_in: float
    score_out: float
    changes: int


class Step(msgspec.Struct, frozen=True):
    """What one τ gives."""

    tau_ns: int
    windows: int
    met: float
    """Windows that the best meets, less its changes out of place, in number."""
    lead: float
    """By how much the next fits worse: windows missed and changes out of place, in number."""
    best: Contender | None = None
    next: Contender | None = None
    """Of those that change at other moments, the one that fits next best."""

    @property
    def tau_s(self) -> float:
        """Half the width of the windows in seconds."""
        return self.tau_ns / 1e9


class Sweep(msgspec.Struct, frozen=True):
    """All steps, and which is suggested; None where nothing changes."""

    steps: list[Step]
    suggested: int | None = None

    @property
    def tau_s(self) -> float:
        """The suggested τ in seconds; InputError where there is none."""
        return self.step.tau_s

    @property
    def step(self) -> Step:
        """The suggested step; InputError where there is none."""
        if self.suggested is None:
            raise InputError("no signal changes, so no tau can be suggested; give --tau")
        return self.steps[self.suggested]

    def reason(self) -> str:
        """Why it is suggested, in a sentence or two for people."""
        step, said = self.step, []
        if step.best is None:
            raise InputError("no signal changes, so no tau can be suggested; give --tau")
        said.append(
            f"tau {step.tau_s:g} s: {step.best.address} meets {step.met:.1f} of {step.windows} "
            "windows, less its changes out of place"
        )
        fewer = [each for each in self.steps if each.met < GOOD * step.met and each.best]
        narrower = [each for each in fewer if each.tau_ns < step.tau_ns]
        wider = [each for each in fewer if each.tau_ns > step.tau_ns]
        if narrower:
            said.append(
                f"{narrower[-1].tau_s:g} s misses changes that lie farther from their events "
                f"({narrower[-1].met:.1f})"
            )
        if wider and wider[0].windows < step.windows:
            said.append(
                f"at {wider[0].tau_s:g} s the windows run into one another "
                f"({wider[0].windows} of them)"
            )
        elif wider:
            said.append(
                f"{wider[0].tau_s:g} s lets more changes in than events ({wider[0].met:.1f})"
            )
        return "; ".join(said)


def sweep_tau(
    log: Log | Any,
    events: Any,
    *,
    taus_s: Sequence[float] | None = None,
    view: View = "all",
    words: Sequence[str] = (),
    label: str | None = None,
    symbols: str | PathLike[str] | None = None,
    naming: str = DEFAULT_NAMING,
) -> Sweep:
    """Tries several τ and says at which the best signal meets most; arguments as of `identify`.

    `taus_s` are the seconds to try; None: those of 0.1 to 30 s that the log's sampling and the
    distance of the events leave room for.
    """
    subject = subject_of(log, symbols=symbols, naming=naming)
    return sweep_in(subject, events_of(events, label), taus_s=taus_s, view=view, words=words)


def sweep_in(
    subject: Subject,
    events: Events,
    *,
    taus_s: Sequence[float] | None = None,
    view: View = "all",
    words: Sequence[str] = (),
) -> Sweep:
    """As `sweep_tau`, with what is searched and the events read before."""
    chosen = _useful(subject, events) if taus_s is None else list(taus_s)
    settings = settings_json(tau_s=0, view=view, share=1, words=(*subject.words, *words))
    swept = _engine.sweep_tau(
        subject.log.engine, events.time_ns, [round(tau * 1e9) for tau in chosen], settings
    )
    return msgspec.json.decode(swept, type=Sweep)


def _useful(subject: Subject, events: Events) -> list[float]:
    """Not below the sampling; not above where all windows have long become one."""
    least = subject.log.scan_interval_s or 0
    useful = [tau for tau in TAUS_S if tau >= least] or [least]
    if len(events) < 2:
        return useful
    widest = float(np.max(np.diff(events.time_ns))) / 1e9
    return [tau for at, tau in enumerate(useful) if at == 0 or 2 * useful[at - 1] <= widest]
