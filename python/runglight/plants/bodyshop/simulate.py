"""One run of a body shop: what its logger saw while it was learned, and afterwards."""

from dataclasses import dataclass
from functools import cached_property
from math import ceil
from random import Random
from typing import Literal

import numpy as np

from runglight.plants.bodyshop.layout import lay_out, symbol_table
from runglight.plants.bodyshop.moments import (
    RESOLUTION_MS,
    UNSURE_TAKTS,
    Moments,
    Takts,
    run_plan,
)
from runglight.plants.bodyshop.plan import ALARM_RATE, Plan
from runglight.plants.bodyshop.schedule import plan_plant
from runglight.plants.bodyshop.sizes import SIZES, Size
from runglight.plants.bodyshop.truth import TransitionTimes, Trigger, Truth
from runglight.plants.run import Columns, PlantRun
from runglight.plants.symbols import Symbol

START_NS = 1_767_592_800 * 1_000_000_000
"""2026-01-05T06:00:00Z, a Monday's early shift."""

FEWEST_LEARNED_TAKTS = 12
TICK_NS = RESOLUTION_MS * 1_000_000
NEVER = np.iinfo(np.int64).max

Part = Literal["all", "learn", "watch"]


@dataclass(frozen=True)
class BodyshopRun:
    """One run in two parts, the second where the first ends, and the truth about both.

    `alarms` is how often an alarm path was taken in each part, to within the takts in which one
    goes over into the other.
    """

    learn: PlantRun
    watch: PlantRun
    all: PlantRun
    size: Size
    plan: Plan
    alarms: tuple[int, int]

    @cached_property
    def symbols(self) -> tuple[Symbol, ...]:
        """The symbol table."""
        return self.learn.symbols

    @cached_property
    def triggers(self) -> tuple[Trigger, ...]:
        """The waits of devices for one another."""
        return Truth(self.plan, self.learn.signals).triggers()

    @cached_property
    def cycle_times(self) -> tuple[TransitionTimes, ...]:
        """The times of every transition of the devices."""
        return Truth(self.plan, self.learn.signals).cycle_times()

    def part(self, part: Part) -> PlantRun:
        """One of the parts, or both as one."""
        return {"all": self.all, "learn": self.learn, "watch": self.watch}[part]


def simulate_bodyshop(
    size: str = "main",
    seed: int = 1,
    learn_events: int | None = None,
    watch_events: int | None = None,
) -> BodyshopRun:
    """Runs a body shop of one of the `SIZES` for so many events (default: the paper's).

    Nothing is broken in it. The watching part takes no path of a device that the learning part
    has not taken; it goes on where that ends, with every device somewhere in its cycle.

    Raises ValueError for a size that does not exist or too short a learning part.
    """
    if size not in SIZES:
        raise ValueError(f"there is no size {size!r}; there are: {', '.join(SIZES)}")
    chosen = SIZES[size]
    learn_events = chosen.learn_events if learn_events is None else learn_events
    watch_events = chosen.watch_events if watch_events is None else watch_events
    layout = Random(seed)
    groups = lay_out(chosen, layout)
    symbols = symbol_table(groups)
    plan = plan_plant(chosen, groups, layout)
    takts = _takts(_events_per_takt(plan), learn_events, watch_events)
    moments = run_plan(plan, takts, np.random.default_rng(seed))
    columns = _columns(plan, moments, learn_events + watch_events, seed)
    signals = tuple(symbol.name for symbol in symbols)

    def run(start: int, end: int) -> PlantRun:
        time_ns, signal_index, value = columns
        last_ns = int(time_ns[end - 1]) if end > start else START_NS
        rows = slice(start, end)
        return PlantRun(
            time_ns[rows], signal_index[rows], value[rows], signals, (), last_ns, symbols
        )

    alarms_learned = int((moments.alarms < takts.learn.stop + UNSURE_TAKTS).sum())
    return BodyshopRun(
        learn=run(0, learn_events),
        watch=run(learn_events, learn_events + watch_events),
        all=run(0, learn_events + watch_events),
        size=chosen,
        plan=plan,
        alarms=(alarms_learned, len(moments.alarms) - alarms_learned),
    )


def simulate_part(
    size: str = "main", seed: int = 1, events: int | None = None, part: Part = "all"
) -> PlantRun:
    """Runs a body shop and gives one part of what its logger saw, or both as one.

    `events` counts both parts; they share it as they share the size's own number.
    """
    if size not in SIZES or events is None:
        return simulate_bodyshop(size, seed).part(part)
    learn, watch = SIZES[size].learn_events, SIZES[size].watch_events
    learn_events = events * learn // (learn + watch)
    return simulate_bodyshop(size, seed, learn_events, events - learn_events).part(part)


def _events_per_takt(plan: Plan) -> float:
    """Events of one takt on average."""
    events = 0.0
    for shape, choice in zip(plan.rows.shape, plan.rows.choice, strict=True):
        share = plan.shares[choice] if choice >= 0 else None
        match shape:
            case "first":
                events += 1 - (share or 0)
            case "second":
                events += share or 0
            case "alarm":
                events += ALARM_RATE
            case _:
                events += 1
    return events


def _takts(per_takt: float, learn_events: int, watch_events: int) -> Takts:
    """How many takts make so many events, the first one starting up cell by cell."""
    learned, total = learn_events / per_takt, (learn_events + watch_events) / per_takt
    if learned < FEWEST_LEARNED_TAKTS:
        raise ValueError(
            f"{learn_events} events to learn from are too few: this plant makes {per_takt:.0f} in "
            f"a takt, and learning takes {FEWEST_LEARNED_TAKTS} of them"
        )
    return Takts(
        count=ceil(total) + UNSURE_TAKTS,
        learn=range(1, int(learned) - UNSURE_TAKTS),
        watch=range(ceil(learned) + UNSURE_TAKTS, max(int(total) - UNSURE_TAKTS, 0)),
    )


def _columns(plan: Plan, moments: Moments, events: int, seed: int) -> Columns:
    """The first events of all, in time order; those of one tick in an order of no meaning."""
    states = 2 * plan.size.signals
    bits = states.bit_length()
    state = 2 * np.array(plan.rows.signal) + np.array(plan.rows.value)
    shuffled = np.random.default_rng(seed).permutation(states)
    # One number holds an event, so one sort of plain numbers brings all into order; in place, as
    # these arrays are the largest there are.
    keys = (moments.time_ms // RESOLUTION_MS).astype(np.int64)
    keys <<= bits
    keys |= shuffled[state][:, np.newaxis]
    keys[moments.skipped_rows] = np.where(moments.skipped, NEVER, keys[moments.skipped_rows])
    keys = keys.ravel()
    keys.sort()
    keys = keys[:events]
    state_of = np.argsort(shuffled)
    places = keys & ((1 << bits) - 1)
    keys >>= bits
    if len(keys) < events or (events and keys[-1] * RESOLUTION_MS >= moments.complete_ms):
        raise AssertionError("too few takts were run for so many events")
    keys *= TICK_NS
    keys += START_NS
    return Columns(keys, (state_of >> 1).astype(np.uint32)[places], (state_of & 1)[places])
