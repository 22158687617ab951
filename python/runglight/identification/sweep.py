"""Which τ? Every one of a list is tried, and the one suggested that sets the best signal apart."""

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
    lead: float
    """By how many windows the best beats the next: difference of score_in times windows."""
    best: Contender | None = None
    next: Contender | None = None
    """The best of those that change at other moments."""

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
        if step.lead <= 0:
            said.append(
                f"no tau sets one signal apart; at {step.tau_s:g} s {step.best.address} is first "
                "by its name only: declare more events, or record longer"
            )
        elif step.next is None:
            said.append(f"tau {step.tau_s:g} s: only {step.best.address} changes")
        else:
            said.append(
                f"tau {step.tau_s:g} s sets the best signal apart most clearly: "
                f"{step.best.address} has a score in of {step.best.score_in:.4f}, the next, "
                f"{step.next.address}, {step.next.score_in:.4f}, {step.lead:.1f} of "
                f"{step.windows} windows more"
            )
        shorter = [each for each in self.steps if each.tau_ns < step.tau_ns and each.best]
        if shorter and shorter[-1].best and shorter[-1].best.score_in > step.best.score_in:
            said.append(
                f"at {shorter[-1].tau_s:g} s events lie too far from their changes "
                f"({shorter[-1].best.score_in:.4f})"
            )
        merged = next((each for each in self.steps if each.windows < step.windows), None)
        if merged is not None:
            said.append(
                f"from {merged.tau_s:g} s on windows run into one another "
                f"({merged.windows} instead of {step.windows})"
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
    """Tries several τ and says which sets the best signal apart; arguments as of `identify`.

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
