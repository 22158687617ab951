"""What should have come instead: edges to draw beside the observed ones."""

from __future__ import annotations

import datetime
from typing import TYPE_CHECKING, Any

import msgspec

from runglight.moments import nanoseconds
from runglight.server.places import state_parts

if TYPE_CHECKING:
    from collections.abc import Iterable

    from runglight.findings.finding import Finding


class Ghost(msgspec.Struct, frozen=True):
    """An edge that was expected; times as decimal text, in nanoseconds since 1970."""

    signal: str
    value: int | None
    probability: float | None
    typical_ns: str | None
    """When it usually comes, counted from when the state before it began."""
    earliest_ns: str | None
    latest_ns: str | None


def ghosts_of(finding: Finding, rules: Iterable[dict[str, Any]]) -> list[Ghost]:
    """The expected edges of a finding, from the model's rules of its device or group."""
    at_ns = time_ns(finding.time)
    began_ns = None if finding.observed_s is None else at_ns - round(finding.observed_s * 1e9)
    of_state: dict[str, list[dict[str, Any]]] = {}
    for rule in rules:
        if rule["current"] == finding.from_state and rule["model"] == finding.model:
            of_state.setdefault(rule["next"], []).append(rule)
    ghosts = []
    for expected in finding.expected:
        signal, value = state_parts(expected.state)
        clusters = [rule for rule in of_state.get(expected.state, []) if rule["average_s"]]
        typical = max(clusters, key=lambda rule: rule["time_probability"] or 0.0, default=None)

        def moment(seconds: float | None) -> str | None:
            if seconds is None or began_ns is None:
                return None
            return str(began_ns + round(seconds * 1e9))

        latest_s = expected.limit_s or (typical or {}).get("late_limit_s")
        ghosts.append(
            Ghost(
                signal=signal,
                value=value,
                probability=expected.probability,
                typical_ns=moment((typical or {}).get("average_s")),
                earliest_ns=moment((typical or {}).get("early_limit_s")),
                latest_ns=moment(latest_s),
            )
        )
    return ghosts


def time_ns(text: str) -> int:
    """Nanoseconds since 1970 of an ISO 8601 time in UTC, all nine digits of it."""
    whole, _, fraction = text.removesuffix("Z").partition(".")
    seconds = nanoseconds(datetime.datetime.fromisoformat(f"{whole}+00:00"))
    return seconds + int(fraction.ljust(9, "0")[:9] or 0)
