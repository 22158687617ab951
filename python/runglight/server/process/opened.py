"""A net that somebody looks at: mined or read, with the runs that follow it where there are any."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

from runglight import _engine
from runglight.control.decisions import Decisions
from runglight.control.guards import said
from runglight.errors import InputError, RunglightError
from runglight.process.openings import changes_of
from runglight.process.token_walk import Step, TokenWalk

if TYPE_CHECKING:
    from runglight.process.event_log import EventLog
    from runglight.process.mining import MinedProcess
    from runglight.process.next_activity import NextActivity
    from runglight.process.petri_net import Fitness, PetriNet, Soundness
    from runglight.server.catalogue import Item
    from runglight.server.places import Place
    from runglight.server.process.variants import Variant


class Foretold(msgspec.Struct, frozen=True):
    """What the network expected, and how probable it thought what came."""

    expected: str
    probability: float


class PlayedEvent(msgspec.Struct, frozen=True):
    """One event of a run."""

    at_s: float
    """Since the run opened."""
    activity: str
    step: Step
    foretold: Foretold | None


@dataclass(frozen=True, slots=True)
class Runs:
    """The runs of a recording, held against the net."""

    log: EventLog
    source: str
    """Name of the recording."""
    fitness: Fitness
    precision: float
    variants: list[Variant]
    different: int
    """Variants there are; not all are listed."""


@dataclass(slots=True)
class OpenedProcess:
    """A net, and everything that is known around it."""

    id: str
    title: str
    net: PetriNet
    soundness: Soundness
    places: dict[str, Place]
    """Where each signal of the net belongs, by the name the net has for it."""
    reset: str | None = None
    mined: MinedProcess | None = None
    runs: Runs | None = None
    guards: str | None = None
    network: NextActivity | None = None
    network_name: str | None = None
    patience_s: float = 0.5
    item: Item | None = None
    """The file it is; None while it is not kept."""
    read_s: float = 0.0
    """When the file had last been changed as it was read."""
    disagreements: list[str] = field(default_factory=list)
    """What the learned controller would have done otherwise in the recording: findings."""
    no_controller: str | None = None
    """Why there is none."""

    def signals(self) -> list[str]:
        """The signals that its activities tell of."""
        labels = [each.label for each in self.net.transitions if each.label is not None]
        if self.runs is not None:
            labels += [name for name, _ in self.runs.log.activities]
        changes = (change for label in labels for change in changes_of(label))
        return list(dict.fromkeys(change.rpartition("=")[0] for change in changes if "=" in change))

    def is_stale(self) -> bool:
        """Whether its file has changed since, or is gone."""
        if self.item is None:
            return False
        try:
            return self.item.path.stat().st_mtime != self.read_s
        except OSError:
            return True

    def shadow(self) -> _engine.Shadow:
        """A learned controller that looks on; InputError where this net cannot control."""
        network = None if self.network is None else self.network.engine
        return _engine.Shadow(self.net.engine, self.guards, network, self.patience_s)

    def decisions(self) -> Decisions | None:
        """What the guards say."""
        return None if self.guards is None else Decisions(self.guards, self.net.engine)

    def guards_in_words(self) -> list[str]:
        """One sentence a decision."""
        if self.guards is None:
            return []
        labels = {each.id: each.label or each.id for each in self.net.transitions}
        points: list[dict[str, Any]] = msgspec.json.decode(self.guards)["points"]
        return [
            f"after {point['after']}: {said(point['choice'], labels)}"
            + (
                f" ({point['contradicted']} of {point['seen']} times otherwise)"
                if point["contradicted"]
                else ""
            )
            for point in points
            if point["choice"] is not None
        ]

    def structured_text(self) -> str:
        """The learned controller as a program; InputError where there is none."""
        return _engine.structured_text_of(self.net.engine, self.guards, [], "learned")

    def run(self, number: int) -> dict[str, object]:
        """One run, event by event, with the tokens; InputError where there is no such run."""
        if self.runs is None or not 0 <= number < self.runs.log.traces:
            raise InputError("there is no such run; look at the list again")
        log = self.runs.log
        activity, time_ns, bounds = log.columns()
        first, end = int(bounds[number]), int(bounds[number + 1])
        names = [log.activities[each][0] for each in activity[first:end]]
        times = [int(each) for each in time_ns[first:end]]
        began_ns = times[0] if times else 0
        steps = TokenWalk(self.net).walk(names)
        told = self._foretold(number, len(names))
        return {
            "number": number,
            "name": log.names[number],
            "began_ms": began_ns / 1e6,
            "events": [
                PlayedEvent((at_ns - began_ns) / 1e9, name, step, told.get(place))
                for place, (at_ns, name, step) in enumerate(zip(times, names, steps, strict=False))
            ],
            "end": steps[-1],
        }

    def _foretold(self, number: int, events: int) -> dict[int, Foretold]:
        if self.network is None or self.runs is None:
            return {}
        try:
            told = self.network.foretell(self.runs.log, [number])
        except RunglightError:
            # A network of other activities says nothing here.
            return {}
        names = self.network.activities
        return {
            int(event): Foretold(names[int(expected)], float(probability))
            for event, expected, probability in zip(
                np.asarray(told["event"]), told["expected"], told["probability"], strict=True
            )
            if 0 < event < events
        }
