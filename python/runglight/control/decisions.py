"""What guards say at a place of the net, for people who watch the learned controller."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from runglight import _engine

Tree = dict[str, Any] | str


class Decisions:
    """The choices of a net's guards, by where the tokens are."""

    def __init__(self, guards: str, net: _engine.PetriNet) -> None:
        self._place = {name: number for number, name in enumerate(net.places)}
        self._transition = {row[0]: number for number, row in enumerate(net.transitions())}
        points: list[dict[str, Any]] = json.loads(guards)["points"]
        self._choices: dict[frozenset[int], Tree] = {
            frozenset(self._place[place] for place in point["marked"]): point["choice"]
            for point in points
            if point["choice"] is not None
        }

    def at(
        self, marking: Mapping[int, int], run: Sequence[int] | None
    ) -> tuple[int, float] | Literal["wait", "uncounted"] | None:
        """A transition and its delay in seconds, or `wait`; None where the net alone says it.

        `run` holds the transitions fired since the run opened; None where it was not seen from
        there, and `uncounted` is the answer where that matters.
        """
        tree = self._choices.get(frozenset(marking))
        while isinstance(tree, dict) and "count" in tree:
            if run is None:
                return "uncounted"
            count = tree["count"]
            tree = count["reached" if self._count(count, run) >= count["preset"] else "below"]
        if tree is None:
            return None
        if isinstance(tree, str):
            return "wait"
        output = tree["output"]
        return self._transition[output["transition"]], float(output["after_s"])

    def _count(self, count: dict[str, Any], run: Sequence[int]) -> int:
        counter = count["counter"]
        since = 0
        if counter["reset_by"] is not None:
            reset = self._transition[counter["reset_by"]]
            since = next((n + 1 for n in range(len(run) - 1, -1, -1) if run[n] == reset), 0)
        return list(run[since:]).count(self._transition[counter["counts"]])
