"""Days of the simulated press, with failures, stops and variations at random times.

Logs are kept in `benches/results`, since they take minutes to make.
"""

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from random import Random

import numpy as np

from runglight.log.changelog import Log, read_log
from runglight.plants.agenda import NS_PER_S
from runglight.plants.press import FAULTS, RunningPress
from runglight.plants.press.simulate import SLICE_NS, START_NS, PressLog
from runglight.plants.press.symbols import ACTUATOR_NAMES

DAY_S = 86_400.0
WORKED_OUT_ON = 2
"""Seed of the days the method was worked out on; what others give, it had not seen."""

FOLDER = Path(__file__).parent / "results" / "press"

NORMAL = (
    *("manual",) * 18,
    *("cycle stop",) * 8,
    *("no parts",) * 8,
    *("slow motion",) * 12,
    *("bounce",) * 8,
)
"""The 54 stops and variations that are no failure."""


@dataclass(frozen=True)
class Happening:
    """Something that was brought on: a failure by its number, or a normal stop or variation."""

    time_ns: int
    kind: str
    number: int | None = None
    shown_ns: int | None = None
    """A failure: when the HMI showed its alarm."""


@dataclass(frozen=True)
class Days:
    """A log and what happened in it."""

    log: Log
    happenings: tuple[Happening, ...]
    days: float
    cycles: int


Actions = dict[str, Callable[[RunningPress, Random], None]]

ACTIONS: Actions = {
    "manual": lambda press, _: press.intervene(),
    "cycle stop": lambda press, random: press.stop_at_end_of_cycle(random.uniform(300.0, 3600.0)),
    "no parts": lambda press, random: press.starve(random.uniform(300.0, 1800.0)),
    "slow motion": lambda press, random: press.vary(random.choice(ACTUATOR_NAMES)),
    "bounce": lambda press, random: press.bounce(random.choice(ACTUATOR_NAMES)),
}


def operation(
    name: str,
    *,
    seed: int,
    days: float | None = None,
    cycles: int | None = None,
    failures: tuple[int, ...] = (),
    normal: tuple[str, ...] = (),
) -> Days:
    """A stretch of operation, with its happenings spread evenly at random."""
    path = FOLDER / f"{name}.parquet"
    truth = path.with_suffix(".json")
    if path.is_file() and truth.is_file():
        told = json.loads(truth.read_text(encoding="utf-8"))
        happenings = tuple(Happening(**each) for each in told["happenings"])
        return Days(read_log(path), happenings, told["days"], told["cycles"])
    random = Random(f"{seed}/days")
    press = RunningPress(START_NS, seed)
    log = PressLog(press, START_NS)
    length_s = days * DAY_S if days is not None else (cycles or 0) * 66.0
    what = [("failure", number) for number in failures] + [(kind, 0) for kind in normal]
    random.shuffle(what)
    # Each has a stretch of its own, so that what follows from it can be told apart.
    room = length_s / max(len(what), 1)
    plan = [
        (START_NS + int((place * room + random.uniform(0.05, 0.6) * room) * NS_PER_S), kind, number)
        for place, (kind, number) in enumerate(what)
    ]
    happenings: list[Happening] = []
    now_ns = START_NS

    def running() -> bool:
        if days is not None:
            return now_ns < START_NS + days * DAY_S * NS_PER_S
        return press.cycles < (cycles or 0)

    while running():
        now_ns += SLICE_NS
        press.advance(now_ns)
        while plan and plan[0][0] <= now_ns:
            _, kind, number = plan.pop(0)
            if kind == "failure":
                press.inject(number)
            else:
                ACTIONS[kind](press, random)
                happenings.append(Happening(now_ns, kind))
    run = log.run(press, now_ns)
    happenings += [
        Happening(label.time_ns, "failure", label.number, label.shown_ns) for label in run.labels
    ]
    happenings.sort(key=lambda each: each.time_ns)
    made = Log.from_columns(run.time_ns, run.signal_index, run.value, run.signals)
    FOLDER.mkdir(parents=True, exist_ok=True)
    made.write(path)
    days = (now_ns - START_NS) / NS_PER_S / DAY_S
    told = {"days": days, "cycles": press.cycles, "happenings": [asdict(h) for h in happenings]}
    truth.write_text(json.dumps(told, indent=1), encoding="utf-8")
    return Days(made, tuple(happenings), days, press.cycles)


def learned_from(cycles: int = 7_000) -> Days:
    """What is learned from: mostly sound, with a few failures and stops that cleaning takes out."""
    stops = tuple(kind for kind in NORMAL if kind in ("manual", "cycle stop", "no parts"))
    return operation(
        f"learned-{cycles}", seed=1, cycles=cycles, failures=(1, 8, 14, 19, 22), normal=stops
    )


def fifteen_days(seed: int = WORKED_OUT_ON) -> Days:
    """Table 3: fifteen days, 24 failures, 54 normal stops and variations."""
    name = "fifteen-days" if seed == WORKED_OUT_ON else f"fifteen-days-{seed}"
    return operation(name, seed=seed, days=15.0, failures=tuple(FAULTS), normal=NORMAL)


def sound_month() -> tuple[Days, ...]:
    """Thirty days without a failure, with twice the stops and variations, in two halves."""
    return tuple(
        operation(f"sound-days-{seed}", seed=seed, days=15.0, normal=NORMAL) for seed in (3, 5)
    )


def manual_returns(number: int = 200) -> Days:
    """An operator takes the machine into manual every few cycles."""
    return operation(f"manual-{number}", seed=4, cycles=number * 4, normal=("manual",) * number)


def polled(log: Log, interval_ns: int, *, bursts: bool, seed: int = 1) -> Log:
    """The log as a slower poll sees it: the image at each poll, changes since the last one.

    `bursts`: in one of twenty minutes the poller is overloaded and takes eight times as long.
    """
    time_ns, signal, value = log.columns()
    start = int(time_ns[0])
    since = time_ns - start
    polls = -(-since // interval_ns) * interval_ns
    if bursts:
        minutes = since // (60 * NS_PER_S)
        slow = np.random.default_rng(seed).random(int(minutes.max()) + 1) < 0.05
        polls = np.where(slow[minutes], -(-since // (8 * interval_ns)) * 8 * interval_ns, polls)
        polls = np.maximum.accumulate(polls)
    order = np.lexsort((np.arange(len(polls)), signal, polls))
    poll_of, signal_of, value_of = polls[order], signal[order], value[order]
    last = np.ones(len(order), dtype=bool)
    last[:-1] = (poll_of[1:] != poll_of[:-1]) | (signal_of[1:] != signal_of[:-1])
    poll_of, signal_of, value_of = poll_of[last], signal_of[last], value_of[last]
    # A signal that was back at its value when looked at has not changed.
    by_signal = np.lexsort((poll_of, signal_of))
    changed = np.ones(len(by_signal), dtype=bool)
    same = (signal_of[by_signal][1:] == signal_of[by_signal][:-1]) & (
        value_of[by_signal][1:] == value_of[by_signal][:-1]
    )
    changed[1:] = ~same
    kept = np.sort(by_signal[changed])
    return Log.from_columns(
        start + poll_of[kept], signal_of[kept].astype(np.uint32), value_of[kept], log.signals
    )
