"""Declared events: when something was seen to happen, `events.csv`."""

from __future__ import annotations

import csv
from collections import Counter
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

from runglight import _engine
from runglight.errors import InputError
from runglight.log.report import ReadReport
from runglight.moments import iso, nanoseconds
from runglight.nearest import suggestion
from runglight.replacing import replacing

if TYPE_CHECKING:
    from collections.abc import Iterable
    from os import PathLike

    import numpy.typing as npt


ANY = "any"
"""As a label: all events, whatever they are called."""


@dataclass(frozen=True, slots=True)
class Events:
    """Moments in time order, and what each is, where it was said."""

    time_ns: npt.NDArray[np.int64]
    labels: tuple[str | None, ...]
    report: ReadReport = field(default_factory=ReadReport)

    @classmethod
    def of(cls, times: Iterable[datetime | int] | npt.NDArray[np.int64]) -> Events:
        """Of aware datetimes, or nanoseconds since 1970."""
        if isinstance(times, np.ndarray):
            time_ns = np.sort(times.astype(np.int64))
        else:
            time_ns = np.array(sorted(nanoseconds(time) for time in times), np.int64)
        return cls(time_ns, (None,) * len(time_ns))

    def __len__(self) -> int:
        return len(self.time_ns)

    def labelled(self, label: str | None, path: str = "events") -> Events:
        """Those of one label, or of `any`; all, where they have but one. InputError else."""
        counted = Counter(name or "" for name in self.labels)
        named = [name for name in counted if name]
        if label == ANY or (label is None and len(counted) < 2):
            return self
        if label is None:
            shown = ", ".join(f"{name} ({counted[name]})" for name in named)
            rest = f", and {counted['']} without a label" if counted[""] else ""
            raise InputError(
                f"{path}: several kinds of events are declared: {shown}{rest}; "
                "say with --label which to identify (or any)"
            )
        if label not in named:
            near = suggestion(label, named) or f"; there are: {', '.join(named) or 'none'}"
            raise InputError(f"{path}: no event has the label {label!r}{near}")
        chosen = [at for at, name in enumerate(self.labels) if name == label]
        return Events(self.time_ns[chosen], (label,) * len(chosen), self.report)

    def write(self, path: Path) -> None:
        """Writes an `events.csv`, to the millisecond, that a user can edit."""
        with replacing(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as to:
            writer = csv.writer(to, lineterminator="\n")
            writer.writerow(["time", "label"])
            for time_ns, label in zip(self.time_ns.tolist(), self.labels, strict=True):
                writer.writerow([iso(time_ns), label or ""])


def read_events(path: str | PathLike[str], *, date: str | None = None) -> Events:
    """Reads an `events.csv`: the column `time` as a log may have it, in any order.

    `date` (`2026-01-31`) is the day of the first event, where the file has only times of day.
    """
    options: dict[str, Any] = {} if date is None else {"date": date}
    times, labels, report = _engine.read_events(str(path), msgspec.json.encode(options).decode())
    return Events(times, tuple(labels), msgspec.json.decode(report, type=ReadReport))
