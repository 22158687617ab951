"""Where signals belong: group, device and address of every signal of a model or a log."""

from __future__ import annotations

import csv
from typing import TYPE_CHECKING

import msgspec

from runglight.configuration import DEFAULT_NAMING

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from runglight.model import NominalModel

UNNAMED_GROUP = "plant"


class Place(msgspec.Struct, frozen=True):
    """One signal, and where it belongs."""

    name: str
    """As the log calls it."""
    group: str
    device: str
    signal: str
    address: str = ""
    type: str = "BOOL"
    description: str = ""

    @property
    def full(self) -> str:
        """`Group1-PrtLDR-RET`: what states of it begin with."""
        return "-".join(part for part in (self.group, self.device, self.signal) if part)

    @property
    def full_device(self) -> str:
        """`Group1-PrtLDR`."""
        return "-".join(part for part in (self.group, self.device) if part)


def places_of_model(model: NominalModel) -> dict[str, Place]:
    """By the names the model uses."""
    naming = str(model.summary()["parameters"]["naming"])
    by_key: dict[str, Place] = {}
    for row in csv.DictReader(model.symbols().splitlines()):
        group, device, signal = row["group"] or "", row["device"] or "", row["signal"] or ""
        place = Place(
            name="",
            group=group,
            device=device,
            signal=signal,
            address=row["address"] or "",
            type=row["type"] or "BOOL",
            description=row["description"] or "",
        )
        named = naming.format(group=group, device=device, signal=signal).strip("-")
        for key in (place.address, signal, named, place.full):
            if key:
                by_key[key] = msgspec.structs.replace(place, name=key)
    return {name: _at(name, by_key) for name in model.signals}


def places_of_log(signals: Iterable[str], known: Mapping[str, Place]) -> list[Place]:
    """Of a log's signals, in its order: as a model knows them, else by the usual naming rule."""
    return [_at(name, known) for name in signals]


def _at(name: str, known: Mapping[str, Place]) -> Place:
    place = known.get(name)
    if place is not None:
        return msgspec.structs.replace(place, name=name)
    separator = DEFAULT_NAMING[len("{group}")]
    parts = name.split(separator, 2)
    if len(parts) == 3 and all(parts):
        return Place(name, *parts)
    return Place(name, UNNAMED_GROUP, "", name, address=name)


def state_parts(state: str) -> tuple[str, int | None]:
    """Signal and value of a signal-state: `…-RET_ON` is 1, `…-STEP=12` is 12."""
    if state.endswith("_ON"):
        return state[:-3], 1
    if state.endswith("_OFF"):
        return state[:-4], 0
    signal, equals, value = state.rpartition("=")
    if equals and value.removeprefix("-").isdecimal():
        return signal, int(value)
    return state, None
