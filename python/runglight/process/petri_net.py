"""Petri nets: what a machine's runs follow."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, NamedTuple

from runglight import _engine

if TYPE_CHECKING:
    from os import PathLike


class Transition(NamedTuple):
    """One transition; a silent one has no label. Places are numbers."""

    id: str
    label: str | None
    signal_class: str | None
    inputs: list[int]
    outputs: list[int]


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


def read_net(path: str | PathLike[str]) -> PetriNet:
    """Reads PNML of runglight, ProM, PM4Py or others."""
    return PetriNet(_engine.PetriNet.read_pnml(os.fspath(path)))
