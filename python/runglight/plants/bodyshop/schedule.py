"""When each step of each device happens after which other: the cells planned step by step.

Devices of a cell move forward together: always the one that is furthest behind gets its next
stretch, and where that begins with a wait, it waits for an event of another device that certainly
comes later than its own last one. So a wait ends with its enabling event in every cycle, whatever
the part, and the planned order is an order of causes.

All times in milliseconds; per part type, counted from the arrival of the cell's part.
"""

import heapq
from collections.abc import Callable
from dataclasses import dataclass
from operator import add, gt
from random import Random
from typing import NamedTuple

from runglight.plants.bodyshop.durations import PROGRAM_SHARE, Durations
from runglight.plants.bodyshop.layout import Cell, Device
from runglight.plants.bodyshop.plan import (
    ARRIVAL_JITTER_MS,
    Plan,
    PlannedDevice,
    Stretch,
    Times,
)
from runglight.plants.bodyshop.rule_number import swapping_pairs
from runglight.plants.bodyshop.sizes import Size
from runglight.plants.bodyshop.steps import Shape

BETWEEN_CELLS_MS = 500
SURELY_LATER_MS = 200
CANDIDATES = 60
JOIN_SHARE = 0.35
SPARE_STEPS = 0.5
"""With it, a device's last program cannot outlast the takt, however long it takes for one part."""


@dataclass(slots=True)
class _Progress:
    """How far a device is planned: its next row, and when its last one happens."""

    number: int
    planned: PlannedDevice
    row: int
    least: Times
    most: Times
    short_ms: int
    """What the steps to come take at most that are no waits and no programs."""
    long_steps: int
    """Waits and programs to come."""


class _Candidate(NamedTuple):
    """An event others may wait for."""

    row: int
    device: int
    least: Times
    most: Times


def plan_plant(size: Size, groups: list[list[Cell]], random: Random) -> Plan:
    """Plans every cell, and spreads the cells of each group over the takt."""
    plan = Plan(size)
    swaps = swapping_pairs(size, groups, random)
    for group, cells in enumerate(groups):
        first_cell = len(plan.group_of_cell)
        spans = [
            _CellPlanner(plan, random, cell, swaps[group][number], group).plan_cell()
            for number, cell in enumerate(cells)
        ]
        _spread(plan, first_cell, spans)
    return plan


def _spread(plan: Plan, first_cell: int, spans: list[int]) -> None:
    """Gives each cell of a group its own part of the takt, none overlapping the next."""
    free = plan.size.shortest_takt_ms - sum(spans)
    if free < 0:
        raise ValueError(f"{len(spans)} cells do not fit into one takt")
    phase = 0
    for span in spans:
        plan.phase_of_cell.append(phase)
        phase += span + free // len(spans)
    assert len(plan.phase_of_cell) == first_cell + len(spans)


class _CellPlanner:
    """Plans one cell."""

    def __init__(self, plan: Plan, random: Random, cell: Cell, swaps: int, group: int) -> None:
        self._plan = plan
        self._rows = plan.rows
        self._random = random
        self._types = plan.size.types
        self._number = len(plan.group_of_cell)
        self._swaps = swaps
        self._latest_end = plan.size.shortest_takt_ms - ARRIVAL_JITTER_MS - BETWEEN_CELLS_MS
        self._durations = Durations(plan.size, random)
        self._candidates: list[_Candidate] = []
        self._when: dict[int, _Candidate] = {}
        self._repeated: set[int] = set()
        """Rows whose state is seen again on an alarm path."""
        plan.group_of_cell.append(group)
        self._devices = [self._enter(number, device) for number, device in enumerate(cell)]

    def plan_cell(self) -> int:
        """Plans all steps of the cell; returns how long its devices take to have all started."""
        span = self._plan_starts()
        behind = [(max(device.most), device.number) for device in self._devices]
        heapq.heapify(behind)
        while behind:
            _, number = heapq.heappop(behind)
            device = self._devices[number]
            if device.row < device.planned.end:
                self._plan_stretch(device, self._triggers(device))
                heapq.heappush(behind, (max(device.most), number))
        for device in self._devices:
            if max(device.most) > self._latest_end:
                raise ValueError(f"{device.planned.device.name} does not fit into the takt")
        return span

    # the rows of a device

    def _enter(self, number: int, device: Device) -> _Progress:
        rows, first = self._rows, len(self._rows.signal)
        first_choice = len(self._plan.shares)
        self._plan.shares.extend(device.cycle.shares)
        for step in device.cycle.steps:
            rows.signal.append(device.signal_of[step.signal])
            rows.value.append(step.value)
            rows.pace.append(step.pace)
            rows.shape.append(step.shape)
            rows.choice.append(-1 if step.choice < 0 else first_choice + step.choice)
            least, most = self._durations.of(step, device.kind.close_times)
            rows.least.append(least)
            rows.most.append(most)
        on_alarm_path = {step.signal for step in device.cycle.steps if step.shape == "alarm"}
        self._repeated.update(
            row
            for row, step in enumerate(device.cycle.steps, first)
            if step.signal in on_alarm_path
        )
        planned = PlannedDevice(device, self._number, first, len(rows.signal))
        self._plan.devices.append(planned)
        paces = rows.pace[first:]
        short_ms = sum(
            max(most)
            for pace, most in zip(paces, rows.most[first:], strict=True)
            if pace not in "pw"
        )
        nothing = (0,) * self._types
        return _Progress(
            number, planned, first, nothing, nothing, short_ms, sum(p in "pw" for p in paces)
        )

    # the stretches of a cell

    def _plan_starts(self) -> int:
        """Starts one device after the other, each when the one before has answered."""
        lead, *followers = self._devices
        before: tuple[int, ...] = (self._plan_start(lead, ()),)
        pairs, alone_next = self._swaps, False
        while followers:
            # Pairs never stand side by side: that would make four orders instead of two.
            together = pairs > 0 and not alone_next and len(followers) > 1
            started, followers = followers[: 1 + together], followers[1 + together :]
            if together:
                self._part_decides_order(*started)
                pairs -= 1
            before = tuple([self._plan_start(device, before) for device in started])
            alone_next = together
        ends = (max(self._when[row].most) for row in before)
        return max(ends) + ARRIVAL_JITTER_MS + BETWEEN_CELLS_MS

    def _plan_start(self, device: _Progress, triggers: tuple[int, ...]) -> int:
        """Plans the first stretch; returns the row in which the starting signal is off again."""
        answer = self._answer(device)
        self._plan_stretch(device, triggers)
        return answer

    def _answer(self, device: _Progress) -> int:
        signals = self._rows.signal
        first = device.planned.first
        return signals.index(signals[first], first + 1)

    def _part_decides_order(self, one: _Progress, other: _Progress) -> None:
        """Lets one start after the other is through for some part types, else before it."""
        rows = self._rows
        for late, early, when_late in ((one, other, (1,)), (other, one, (0, 2))):
            first, stroke = late.planned.first, range(early.planned.first, self._answer(early) + 1)
            delay = [
                sum(rows.most[row][kind] for row in stroke) + 300 if kind in when_late else 0
                for kind in range(self._types)
            ]
            for times in (rows.least, rows.most):
                times[first] = tuple(map(add, times[first], delay))

    def _plan_stretch(self, device: _Progress, triggers: tuple[int, ...]) -> None:
        """Plans from a wait to the next one."""
        rows, first = self._rows, device.row
        if not triggers and first > device.planned.first:
            # Nobody to wait for: a timer of its own.
            rows.pace[first] = "p"
            triggers = (first - 1,)
        elif triggers:
            device.least, device.most = self._later_of([self._when[row] for row in triggers])
        row = first
        while row < device.planned.end and (row == first or rows.pace[row] != "w"):
            row = self._plan_steps(device, row)
        device.row = row
        self._plan.stretches.append(Stretch(first, row, triggers, self._number))

    def _plan_steps(self, device: _Progress, row: int) -> int:
        """Plans one step, or all the paths of one choice; returns the row after them."""
        rows = self._rows
        end = row + 1
        if rows.shape[row] == "always":
            device.least, device.most = self._after(device, row)
            self._tell(device, row)
            return end
        while rows.shape[end] != "always":
            end += 1
        paths: dict[Shape, tuple[Times, Times]] = {}
        start = device.least, device.most
        for each in range(row, end):
            device.least, device.most = paths.get(rows.shape[each], start)
            paths[rows.shape[each]] = self._after(device, each)
        if rows.shape[row] == "alarm":
            paths["always"] = start
        device.least = self._by_type(min, [least for least, _ in paths.values()])
        device.most = self._by_type(max, [most for _, most in paths.values()])
        return end

    def _after(self, device: _Progress, row: int) -> tuple[Times, Times]:
        """When a step happens after the one before; gives a program its time."""
        rows = self._rows
        if rows.pace[row] in "pw":
            if rows.pace[row] == "p":
                rows.least[row], rows.most[row] = self._durations.program(
                    self._share_of_takt(device)
                )
            device.long_steps -= 1
        else:
            device.short_ms -= max(rows.most[row])
        return (
            tuple(map(add, device.least, rows.least[row])),
            tuple(map(add, device.most, rows.most[row])),
        )

    def _share_of_takt(self, device: _Progress) -> float:
        """What is left of the takt for each long step to come, and some to spare."""
        free = self._latest_end - max(device.most) - device.short_ms
        return max(free, 0) / (device.long_steps + SPARE_STEPS)

    # waiting for one another

    def _tell(self, device: _Progress, row: int) -> None:
        """Remembers when a step happens; others may wait for it if it is seen once a cycle."""
        event = _Candidate(row, device.number, device.least, device.most)
        self._when[row] = event
        if self._rows.pace[row] in "mpf" and row not in self._repeated:
            self._candidates.append(event)

    def _triggers(self, device: _Progress) -> tuple[int, ...]:
        """One or two events of other devices that certainly come later, if there are any."""
        share = self._share_of_takt(device)
        own = [at + SURELY_LATER_MS for at in device.most]
        latest = max(device.most) + share * 1.3
        later = [
            event
            for event in self._candidates[-CANDIDATES:]
            if event.device != device.number
            and max(event.most) < latest
            and all(map(gt, event.least, own))
        ]
        if not later:
            return ()
        wanted = max(device.most) + share * self._random.uniform(*PROGRAM_SHARE)
        first = min(later, key=lambda event: abs(event.most[0] - wanted))
        rivals = [event for event in later if _either_first(event, first)]
        if rivals and self._random.random() < JOIN_SHARE:
            return first.row, self._random.choice(rivals).row
        return (first.row,)

    def _later_of(self, events: list[_Candidate]) -> tuple[Times, Times]:
        return (
            self._by_type(max, [event.least for event in events]),
            self._by_type(max, [event.most for event in events]),
        )

    def _by_type(self, choose: Callable[[list[int]], int], times: list[Times]) -> Times:
        return tuple(choose([each[kind] for each in times]) for kind in range(self._types))


def _either_first(one: _Candidate, other: _Candidate) -> bool:
    """True where events of two devices come now in this order, now in that."""
    return one.device != other.device and any(
        a < d and c < b
        for a, b, c, d in zip(one.least, one.most, other.least, other.most, strict=True)
    )
