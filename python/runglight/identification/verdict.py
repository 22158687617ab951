"""What a ranking says, in one sentence for people."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from runglight.identification.identify import Identification

SHOWN = 6
"""Addresses that are named; nobody reads a sentence of forty."""


def verdict(found: Identification) -> str:
    """Which address it is, or what would tell."""
    first = found.first()
    if not first:
        return "no signal changes: record the machine while it works"
    kinds = {each.same_as for each in first}
    more = ", …" if len(first) > SHOWN else ""
    names = ", ".join(each.address for each in first[:SHOWN]) + more
    if len(first) == 1:
        return f"best: {names}"
    if len(kinds) == 1:
        return f"best: {names}: they change at the same moments, and are copies of one another here"
    return (
        f"best: {names}: equal scores, but not the same moments; "
        "declare more events, or take another tau or view"
    )
