"""The workshop a request is answered from, and what rooms keep beside it."""

from collections.abc import Callable
from typing import TypeVar

from starlette.requests import Request

from runglight.server.workshop import Workshop

Kept = TypeVar("Kept")


def workshop_of(request: Request) -> Workshop:
    """Put there by `application`."""
    workshop = request.app.state.workshop
    assert isinstance(workshop, Workshop)
    return workshop


def kept_of(request: Request, make: Callable[[Workshop], Kept]) -> Kept:
    """What a room keeps as long as the server runs; made when it is first asked for."""
    state = request.app.state
    if not hasattr(state, "kept"):
        state.kept = {}
    kept: dict[Callable[[Workshop], Kept], Kept] = state.kept
    if make not in kept:
        kept[make] = make(workshop_of(request))
    return kept[make]
