"""The truth about what was done to a log: one label per fault."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import msgspec
import numpy as np

from runglight.errors import InputError
from runglight.injection.kinds import InjectionKind
from runglight.replacing import replacing

if TYPE_CHECKING:
    from collections.abc import Sequence
    from os import PathLike


class InjectionLabel(msgspec.Struct, frozen=True, kw_only=True):
    """One fault. Times are ISO 8601, UTC, to the nanosecond."""

    id: str
    time: str
    """When it first shows: the unknown transition, the maximum passed, the minimum missed."""
    start: str
    """When what was changed begins."""
    end: str
    """When the last event that was changed, or that follows from it, has passed."""
    kind: InjectionKind
    group: str
    device: str | None = None
    """None where the whole group stalls."""
    signal: str | None = None
    from_state: str | None = msgspec.field(name="from", default=None)
    """The first departing transition, in full state names; of a stall the last state."""
    to_state: str | None = msgspec.field(name="to", default=None)
    size_s: float | None = None
    """Seconds over the true maximum, or under the true minimum."""
    share: float | None = None
    """By how much the share of the transition or time grew."""
    description: str

    @property
    def time_ns(self) -> int:
        """`time` in nanoseconds since 1970."""
        return nanoseconds(self.time)

    @property
    def start_ns(self) -> int:
        """`start` in nanoseconds since 1970."""
        return nanoseconds(self.start)

    @property
    def end_ns(self) -> int:
        """`end` in nanoseconds since 1970."""
        return nanoseconds(self.end)


def iso(time_ns: int) -> str:
    """`2026-01-05T06:05:13.24Z`: as many decimals as it takes."""
    text = str(np.datetime64(time_ns, "ns"))
    return text.rstrip("0").rstrip(".") + "Z"


def nanoseconds(time: str) -> int:
    """Nanoseconds since 1970 of an ISO 8601 time in UTC."""
    return int(np.datetime64(time.removesuffix("Z"), "ns").astype(np.int64))


def labels_json(labels: Sequence[InjectionLabel]) -> str:
    """The labels as a JSON list, one object each."""
    return msgspec.json.format(msgspec.json.encode(list(labels)), indent=2).decode() + "\n"


def write_labels(labels: Sequence[InjectionLabel], path: str | PathLike[str]) -> None:
    """Writes the labels as JSON; the file appears whole or not at all."""
    with replacing(Path(path)) as temporary:
        temporary.write_text(labels_json(labels), encoding="utf-8")


def read_labels(path: str | PathLike[str]) -> list[InjectionLabel]:
    """Reads labels that `write_labels` or `runglight simulate faults --labels` wrote."""
    try:
        return msgspec.json.decode(Path(path).read_bytes(), type=list[InjectionLabel])
    except (msgspec.DecodeError, ValueError) as error:
        raise InputError(f"{path}: no labels of injected faults: {error}") from None
