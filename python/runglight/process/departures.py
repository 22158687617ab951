"""Where a run leaves its net, in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

import msgspec

if TYPE_CHECKING:
    from collections.abc import Sequence

    from runglight.process.petri_net import PetriNet
    from runglight.process.token_walk import TokenWalk


class Departure(msgspec.Struct, frozen=True):
    """The first event of a run that the net does not allow."""

    event: int
    """Its number in the run, from 0; the number of events where the run ends too early."""
    activity: str | None
    """None: the run ends."""
    known: bool
    """Whether the net has such an activity at all."""
    allowed: list[str]
    """What the net allows instead; nothing: only the end."""


def departure(walk: TokenWalk, net: PetriNet, run: Sequence[str]) -> Departure | None:
    """Where a run first departs; None where the walk finds a way through."""
    steps = walk.walk(run)
    at = next((number for number, step in enumerate(steps) if step.departs), None)
    if at is None:
        return None
    walk.restart()
    for activity in run[:at]:
        walk.step(activity)
    transitions = net.transitions
    allowed = dict.fromkeys(transitions[number].label or "" for number in walk.enabled())
    ended = at == len(run)
    return Departure(
        event=at,
        activity=None if ended else run[at],
        known=ended or walk.knows(run[at]),
        allowed=list(allowed),
    )
