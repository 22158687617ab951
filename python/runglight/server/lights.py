"""Stack lights: what a look from the door tells of every device and group."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import msgspec

from runglight.findings.finding import full_name

if TYPE_CHECKING:
    from runglight.server.incidents import Incidents

Colour = Literal["green", "amber", "red", "grey"]
_ORDER: tuple[Colour, ...] = ("grey", "green", "amber", "red")


class Light(msgspec.Struct, frozen=True):
    """One stack light."""

    colour: Colour
    blinks: bool
    """Something nobody has acknowledged yet."""


class DeviceLight(msgspec.Struct, frozen=True):
    """A device of a group, its light and its last signal-state."""

    device: str
    light: Light
    state: str | None = None
    since_ms: float | None = None


class GroupLight(msgspec.Struct, frozen=True):
    """A group and its devices."""

    group: str
    light: Light
    devices: list[DeviceLight]


def trouble(incidents: Incidents) -> dict[str, Light]:
    """The lights that open incidents turn on, by the full name of a device or group.

    Red: a fault that stands. Amber: an anomaly, a fault the machine came back from that nobody
    has seen yet, or one that is acknowledged.
    """
    lights: dict[str, Light] = {}
    for incident in incidents.open():
        state = incidents.state(incident)
        for finding in incident.findings.values():
            if finding.severity == "notice":
                continue
            grave = finding.severity == "fault" and incident.stands
            light = Light("red" if grave else "amber", state != "acknowledged")
            place = full_name(finding.group, finding.device)
            lights[place] = _worse(lights.get(place), light)
    return lights


def lit(place: str, lights: dict[str, Light], *, seen: bool) -> Light:
    """The light of one place; grey where nothing is known of it."""
    if not seen:
        return Light("grey", False)
    return lights.get(place, Light("green", False))


def worst(lights: list[Light]) -> Light:
    """The light of a group: the worst of its devices'."""
    found: Light | None = None
    for light in lights:
        found = _worse(found, light)
    return found or Light("grey", False)


def _worse(one: Light | None, other: Light) -> Light:
    if one is None:
        return other
    colour = max(one.colour, other.colour, key=_ORDER.index)
    return Light(colour, one.blinks or other.blinks)
