"""Petri nets: what a machine's runs follow."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, NamedTuple

import msgspec

from runglight import _engine
from runglight.drawing import draw_svg

if TYPE_CHECKING:
    from os import PathLike

    from runglight.process.event_log import EventLog


class Transition(NamedTuple):
    """One transition; a silent one has no label. Places are numbers."""

    id: str
    label: str | None
    signal_class: str | None
    inputs: list[int]
    outputs: list[int]


class Soundness(msgspec.Struct, frozen=True):
    """Whether a net is sound; `problems` are sentences that say where it is not."""

    sound: bool | None
    """None where the net has too many markings to tell."""
    problems: list[str]
    markings: int
    """Markings looked at."""


class Fitness(msgspec.Struct, frozen=True):
    """Token replay of an event log."""

    fitness: float
    """½ (1 - missing/consumed) + ½ (1 - remaining/produced), over all traces."""
    fitting: int
    """Traces the net allows as they stand."""
    traces: int
    produced: int
    consumed: int
    missing: int
    remaining: int


class Quality(NamedTuple):
    """What is known of a net and the runs that should follow it."""

    soundness: Soundness
    fitness: Fitness
    precision: float


class PetriNet:
    """A labelled Petri net with an initial and a final marking."""

    def __init__(self, engine_net: _engine.PetriNet) -> None:
        self._engine = engine_net

    def __repr__(self) -> str:
        places, transitions = len(self.places), len(self.transitions)
        return f"<runglight.PetriNet of {places:,} places, {transitions:,} transitions>"

    @property
    def engine(self) -> _engine.PetriNet:
        """The compiled engine's net."""
        return self._engine

    @property
    def name(self) -> str:
        """Name told to readers of the file."""
        return self._engine.name

    @property
    def places(self) -> list[str]:
        """Identifier of each place."""
        return self._engine.places

    @property
    def transitions(self) -> list[Transition]:
        """All transitions, silent ones too."""
        return [Transition(*row) for row in self._engine.transitions()]

    @property
    def initial(self) -> list[int]:
        """Tokens of each place before the first event."""
        return self._engine.initial

    @property
    def last(self) -> list[int]:
        """Tokens of each place after the last event."""
        return self._engine.last

    def write(self, path: str | PathLike[str]) -> None:
        """Writes PNML; the file appears whole or not at all."""
        self._engine.write_pnml(os.fspath(path))

    def dot(self) -> str:
        """Graphviz text: the first place green, the last one red, inputs blue, outputs orange."""
        return self._engine.dot()

    def svg(self) -> str:
        """The drawing, by a Graphviz program."""
        return draw_svg(self.dot())

    def soundness(self) -> Soundness:
        """Whether every run can end, with nothing left over and no activity that never happens."""
        return msgspec.json.decode(self._engine.soundness_json(), type=Soundness)

    def fitness(self, log: EventLog) -> Fitness:
        """How well the runs follow the net, by token replay."""
        return msgspec.json.decode(self._engine.fitness_json(log.engine), type=Fitness)

    def precision(self, log: EventLog) -> float:
        """How much of what the net allows was seen, by escaping edges: 1 is all of it."""
        return self._engine.precision(log.engine)

    def quality(self, log: EventLog) -> Quality:
        """Soundness, fitness and precision together."""
        return Quality(self.soundness(), self.fitness(log), self.precision(log))


def read_net(path: str | PathLike[str]) -> PetriNet:
    """Reads PNML of runglight, ProM, PM4Py or others."""
    return PetriNet(_engine.PetriNet.read_pnml(os.fspath(path)))
