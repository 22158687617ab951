"""A plan run over many takts at once: rows are steps, columns are takts."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from runglight.plants.bodyshop.plan import ALARM_RATE, ARRIVAL_JITTER_MS, Plan

LONGEST_TAKT = 1.2
"""Takts vary from the shortest to this multiple of it."""

RESOLUTION_MS = 10
UNSURE_TAKTS = 3
"""So many takts before and after the end of learning may lie on either side of it."""

LEARNED_AT_LEAST = 3
"""Every way of every choice is taken so often while learning."""

Matrix = npt.NDArray[np.int32]


@dataclass(frozen=True, slots=True)
class Takts:
    """How many takts to run, and which surely fall into the learning and the watching part."""

    count: int
    learn: range
    watch: range


@dataclass(frozen=True, slots=True)
class Moments:
    """When every step happens in every takt, and whether it does."""

    time_ms: Matrix
    """Since the start of the plant; by row of the plan and takt."""

    skipped_rows: npt.NDArray[np.intp]
    """Rows that do not happen in every takt …"""

    skipped: npt.NDArray[np.bool_]
    """… and in which takts they do not."""

    alarms: npt.NDArray[np.int64]
    """Takt of every alarm path taken."""

    complete_ms: int
    """Nothing before this time is missing."""


def run_plan(plan: Plan, takts: Takts, random: np.random.Generator) -> Moments:
    """Draws every choice and every duration, and adds them up along the causes."""
    rows = plan.rows
    types = _part_types(plan, takts, random)
    choices = _choices(plan, takts, random)
    choice = np.array(rows.choice, dtype=np.int32)
    optional = np.flatnonzero(choice >= 0)
    shape = np.array(rows.shape)
    swapped = np.flatnonzero(shape == "either order")[::2]
    optional = optional[shape[optional] != "either order"]
    skipped = choices[choice[optional]] == (shape[optional] == "first")[:, np.newaxis]

    duration = _durations(plan, types, random)
    duration[optional] *= ~skipped
    arrival, complete_ms = _arrivals(plan, takts, random)
    time = _add_up(plan, duration, arrival)
    _swap(time, swapped, choices[choice[swapped]])
    alarm = np.array([share is None for share in plan.shares], dtype=bool)
    return Moments(time, optional, skipped, np.nonzero(choices[alarm])[1], complete_ms)


def _part_types(plan: Plan, takts: Takts, random: np.random.Generator) -> npt.NDArray[np.int8]:
    """The part type in each cell and takt."""
    size = plan.size
    drawn = random.random((len(plan.group_of_cell), takts.count))
    types = np.digitize(drawn, size.type_bounds).astype(np.int8)
    for kind in range(size.types):
        _assure(types, kind, takts)
    return types


def _choices(plan: Plan, takts: Takts, random: np.random.Generator) -> npt.NDArray[np.bool_]:
    """Whether each choice takes its second way, by takt."""
    shares = np.array([ALARM_RATE if share is None else share for share in plan.shares])
    alarm = np.array([share is None for share in plan.shares], dtype=bool)
    taken = random.random((len(shares), takts.count)) < shares[:, np.newaxis]
    usual = taken[~alarm]
    _assure(usual, 1, takts)
    _assure(usual, 0, takts)
    taken[~alarm] = usual
    # What is never seen in learning stays unseen in watching.
    seen = taken[:, takts.learn.start : takts.learn.stop].any(axis=1)
    taken[alarm & ~seen] = False
    return taken


def _assure(drawn: npt.NDArray[Any], outcome: int, takts: Takts) -> None:
    """Sees to it that an outcome happens in every row in both parts.

    Different outcomes get different takts, so one does not undo another.
    """
    for part, least in ((takts.learn, LEARNED_AT_LEAST), (takts.watch, 1)):
        window = drawn[:, part.start : part.stop]
        spread = np.linspace(0, len(part), least + 2).astype(int)[1:-1] + outcome
        seldom = (window == outcome).sum(axis=1) < least
        if len(part) > least * 3:
            for place in spread:
                window[seldom, place] = outcome


def _durations(plan: Plan, types: npt.NDArray[np.int8], random: np.random.Generator) -> Matrix:
    """How long each step takes after what it comes after: bounded, most often in the middle."""
    least = np.array(plan.rows.least, dtype=np.int32)
    width = np.array(plan.rows.most, dtype=np.int32) - least + 1
    takts = types.shape[1]
    shape = (len(least), takts)
    drawn = random.random(shape, dtype=np.float32)
    drawn += random.random(shape, dtype=np.float32)
    drawn *= np.float32(0.4999999)
    # Doubly drawn and halved it never reaches 1, so no duration passes its greatest.
    several = np.flatnonzero(
        (least != least[:, :1]).any(axis=1) | (width != width[:, :1]).any(axis=1)
    )
    cell_of_row = np.empty(len(least), dtype=np.intp)
    for device in plan.devices:
        cell_of_row[device.first : device.end] = device.cell
    kind = types[cell_of_row[several]]
    of_type = drawn[several] * np.take_along_axis(width[several], kind.astype(np.intp), axis=1)
    drawn *= width[:, :1]
    duration = drawn.astype(np.int32)
    duration += least[:, :1]
    duration[several] = of_type.astype(np.int32) + np.take_along_axis(
        least[several], kind.astype(np.intp), axis=1
    )
    return duration


def _arrivals(plan: Plan, takts: Takts, random: np.random.Generator) -> tuple[Matrix, int]:
    """When a part arrives in each cell; and until when all groups have had all their takts."""
    size = plan.size
    lengths = size.shortest_takt_ms * random.uniform(1, LONGEST_TAKT, (size.groups, takts.count))
    starts = np.cumsum(lengths, axis=1)
    complete_ms = int(starts[:, -1].min())
    starts -= lengths
    starts += random.uniform(0, size.shortest_takt_ms / 60, (size.groups, 1))
    phases = np.array(plan.phase_of_cell)[:, np.newaxis]
    jitter = random.integers(0, ARRIVAL_JITTER_MS, (len(phases), takts.count))
    arrival = starts[plan.group_of_cell].astype(np.int64) + phases + jitter
    return arrival.astype(np.int32), complete_ms


def _add_up(plan: Plan, duration: Matrix, arrival: Matrix) -> Matrix:
    time = np.empty_like(duration)
    for stretch in plan.stretches:
        part = time[stretch.first : stretch.end]
        np.cumsum(duration[stretch.first : stretch.end], axis=0, out=part)
        match stretch.triggers:
            case ():
                part += arrival[stretch.cell]
            case (one,):
                part += time[one]
            case one, other:
                part += np.maximum(time[one], time[other])
    return time


def _swap(time: Matrix, first_rows: npt.NDArray[np.intp], swap: npt.NDArray[np.bool_]) -> None:
    """Exchanges two neighbouring steps where they come in the other order."""
    first, second = time[first_rows], time[first_rows + 1]
    time[first_rows] = np.where(swap, second, first)
    time[first_rows + 1] = np.where(swap, first, second)
