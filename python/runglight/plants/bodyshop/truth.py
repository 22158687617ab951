"""What is true of a body shop: which events enable which, and how long everything takes."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from runglight.plants.bodyshop.moments import RESOLUTION_MS
from runglight.plants.bodyshop.plan import Plan, PlannedDevice
from runglight.plants.faults import Transition

After = Literal["device", "triggers", "arrival", "people"]
"""What a transition comes after: the device's own last event, in tight times; the later of its
triggers; the arrival of a part, whenever that is; the device's own last event, but people or
material take the time they take."""

Range = tuple[float, float]
"""Least and most seconds, as the log shows them."""


@dataclass(frozen=True, slots=True)
class Trigger:
    """A wait for neighbours: the later of `states` enables the device's next state.

    `transitions` are the ways the device comes to it; `delays_s` are counted from the later one.
    """

    group: str
    device: str
    transitions: tuple[Transition, ...]
    states: tuple[str, ...]
    delays_s: tuple[Range, ...]


@dataclass(frozen=True, slots=True)
class TransitionTimes:
    """All times of one transition of a device, shortest first, each with its true least and most.

    They are counted from what the transition comes `after`; an arrival has none.
    """

    group: str
    device: str
    transition: Transition
    after: After
    times_s: tuple[Range, ...]


class Truth:
    """Reads the truth off a plan."""

    def __init__(self, plan: Plan, signals: tuple[str, ...]) -> None:
        self._plan = plan
        self._signals = signals
        self._causes = {
            stretch.first: stretch.triggers
            for stretch in plan.stretches
            if plan.rows.pace[stretch.first] == "w"
        }

    def triggers(self) -> tuple[Trigger, ...]:
        """Every wait of every device for others."""
        found: list[Trigger] = []
        for planned in self._plan.devices:
            ways: dict[int, list[Transition]] = {}
            for before, row, _ in _ways(self._plan, planned):
                if self._causes.get(row):
                    ways.setdefault(row, []).append((self._state(before), self._state(row)))
            found.extend(
                Trigger(
                    planned.device.group,
                    planned.device.name,
                    tuple(transitions),
                    tuple(self._state(cause) for cause in self._causes[row]),
                    self._ranges([row]),
                )
                for row, transitions in ways.items()
            )
        return tuple(found)

    def cycle_times(self) -> tuple[TransitionTimes, ...]:
        """Every transition of every device, alarm paths too."""
        found: list[TransitionTimes] = []
        for planned in self._plan.devices:
            durations: dict[Transition, list[int]] = {}
            for before, row, duration in _ways(self._plan, planned):
                transition = self._state(before), self._state(row)
                durations.setdefault(transition, []).append(duration)
            found.extend(
                TransitionTimes(
                    planned.device.group,
                    planned.device.name,
                    transition,
                    after := self._after(rows[0]),
                    () if after == "arrival" else self._ranges(rows),
                )
                for transition, rows in durations.items()
            )
        return tuple(found)

    def _after(self, row: int) -> After:
        match self._plan.rows.pace[row]:
            case "w":
                return "triggers" if self._causes[row] else "arrival"
            case "f":
                return "people"
            case _:
                return "device"

    def _ranges(self, rows: list[int]) -> tuple[Range, ...]:
        """Times of some rows: the log's clock cuts both ends of a duration off to its tick."""
        durations = {
            (
                least // RESOLUTION_MS * RESOLUTION_MS / 1000,
                -(-most // RESOLUTION_MS) * RESOLUTION_MS / 1000,
            )
            for row in rows
            for least, most in zip(
                self._plan.rows.least[row], self._plan.rows.most[row], strict=True
            )
        }
        return tuple(sorted(durations))

    def _state(self, row: int) -> str:
        rows = self._plan.rows
        return f"{self._signals[rows.signal[row]]}_{'ON' if rows.value[row] else 'OFF'}"


def _ways(plan: Plan, planned: PlannedDevice) -> Iterator[tuple[int, int, int]]:
    """Every way from a row to the next, with the row whose duration it takes."""
    shape = plan.rows.shape
    before = [planned.end - 1]
    row = planned.first
    while row < planned.end:
        end = row + 1
        while shape[row] != "always" and shape[end] != "always":
            end += 1
        match shape[row]:
            case "either order":
                yield from ((each, row, row) for each in before)
                yield from ((each, row + 1, row) for each in before)
                yield row, row + 1, row + 1
                yield row + 1, row, row + 1
                before = [row, row + 1]
            case "alarm":
                yield from ((each, row, row) for each in before)
                yield from ((each - 1, each, each) for each in range(row + 1, end))
                before = [*before, end - 1]
            case "first":
                second = shape.index("second", row)
                for start, stop in ((row, second), (second, end)):
                    yield from ((each, start, start) for each in before)
                    yield from ((each - 1, each, each) for each in range(start + 1, stop))
                before = [second - 1, end - 1]
            case _:
                yield from ((each, row, row) for each in before)
                before = [row]
        row = end
