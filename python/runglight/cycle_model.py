"""The cycle machine of a model: regions of bits, and what they go through (Guim & Dias 2023)."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from runglight import _engine
    from runglight.model import Monitor


class CycleModel:
    """The cycle machine of a plant: regions of bits, and an automaton of each in work and set-up.

    Phases are `work` and `setup`.
    """

    def __init__(self, engine_model: _engine.CycleModel) -> None:
        self._engine = engine_model

    def summary(self) -> dict[str, Any]:
        """Regions with their bits, sequences learned from, sizes of the automata."""
        summary: dict[str, Any] = json.loads(self._engine.summary_json())
        return summary

    def machine(self, region: str, phase: str = "work") -> dict[str, Any]:
        """States (`word`, `initial`, `final`) and transitions (`from`, `to`, `weight`)."""
        machine: dict[str, Any] = json.loads(self._engine.machine_json(region, phase))
        return machine

    def candidates(
        self, region: str, at: str, seen: str, phase: str = "work"
    ) -> list[dict[str, Any]]:
        """What could have followed the word `at` where `seen` came, both in hexadecimal."""
        candidates: list[dict[str, Any]] = json.loads(
            self._engine.candidates_json(region, phase, at, seen)
        )
        return candidates

    def dot(self, region: str, phase: str = "work") -> str:
        """Graphviz text: initial states blue, final ones red, both green."""
        return self._engine.dot(region, phase)

    def monitor(self, state: bytes | None = None) -> Monitor:
        """A monitor of the cycle machine alone."""
        # The nominal model holds a cycle model: the two rooms know one another.
        from runglight.model import Monitor  # noqa: PLC0415

        return Monitor(self._engine.monitor(state))
