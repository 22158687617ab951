"""Days of the simulated press, with failures, stops and variations at random times.

Logs are kept in `benches/results`, since they take minutes to make.
"""

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from random import Random
from typing import Any

from runglight.log.changelog import Log, read_log
from runglight.plants.agenda import NS_PER_S
from runglight.plants.image_log import ImageLog
from runglight.plants.press import FAULTS, SYMBOLS, RunningPress
from runglight.plants.press.simulate import SLICE_NS, START_NS
from runglight.plants.press.symbols import ACTUATOR_NAMES

DAY_S = 86_400.0
CYCLE_S = 66.0
"""A cycle of work and set-up takes about so long, the wait for a part included."""
WORKED_OUT_ON = 2
"""Seed of the days the method was worked out on; what others give, it had not seen."""

FOLDER = Path(__file__).parent / "results" / "press"

NORMAL = (
    *("manual",) * 10,
    *("slow motion",) * 8,
    *("bounce",) * 6,
    # From here on the alarm bit rises although nothing is broken.
    *("cycle stop",) * 6,
    *("no parts",) * 6,
    *("stop button",) * 6,
    *("curtain",) * 6,
    *("door",) * 4,
    *("emergency stop",) * 2,
)
"""The 54 stops and variations that are no failure: 24 without the alarm bit, 30 that may raise it.

Parts that stay away for less than a quarter of an hour raise none.
"""

LEARNED_STOPS = (
    *("manual",) * 18,
    *("cycle stop",) * 8,
    *("no parts",) * 8,
    *("stop button",) * 8,
    *("curtain",) * 10,
    *("door",) * 6,
    *("emergency stop",) * 4,
)
"""What operators do in the days that are learned from."""


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
    "slow motion": lambda press, random: press.vary(random.choice(ACTUATOR_NAMES)),
    "bounce": lambda press, random: press.bounce(random.choice(ACTUATOR_NAMES)),
    "cycle stop": lambda press, random: press.stop_at_end_of_cycle(random.uniform(300.0, 3600.0)),
    "no parts": lambda press, random: press.starve(random.uniform(300.0, 1800.0)),
    "stop button": lambda press, random: press.press_stop(random.uniform(0.3, 1.0)),
    "curtain": lambda press, random: press.reach_in(random.uniform(0.5, 5.0)),
    "door": lambda press, random: press.open_door(random.uniform(10.0, 180.0)),
    "emergency stop": lambda press, random: press.press_emergency_stop(random.uniform(5.0, 60.0)),
}


class Plan:
    """What happens to a press in a stretch of operation, at random times, each in its own part."""

    def __init__(
        self,
        press: RunningPress,
        *,
        seed: int,
        days: float | None = None,
        cycles: int | None = None,
        failures: tuple[int, ...] = (),
        normal: tuple[str, ...] = (),
        worn: tuple[str, float, float] | None = None,
    ) -> None:
        """`worn`: whose end cushion wears out, from which day on, and in how many days."""
        self._press = press
        self._worn = worn
        self._days = days
        self._cycles = cycles or 0
        self._random = random = Random(f"{seed}/days")
        length_s = days * DAY_S if days is not None else self._cycles * CYCLE_S
        what = [("failure", number) for number in failures] + [(kind, 0) for kind in normal]
        random.shuffle(what)
        # Each has a stretch of its own, so that what follows from it can be told apart.
        room = length_s / max(len(what), 1)
        self._ahead = [
            (START_NS + int((place + random.uniform(0.05, 0.6)) * room * NS_PER_S), kind, number)
            for place, (kind, number) in enumerate(what)
        ]
        self._happened: list[Happening] = []

    @property
    def next_ns(self) -> int | None:
        """When the next thing is to happen."""
        return self._ahead[0][0] if self._ahead else None

    def follow(self, now_ns: int) -> bool:
        """Brings on what is due; False once the stretch is over."""
        while self._ahead and self._ahead[0][0] <= now_ns:
            _, kind, number = self._ahead.pop(0)
            if kind == "failure":
                self._press.inject(number)
            else:
                ACTIONS[kind](self._press, self._random)
                self._happened.append(Happening(now_ns, kind))
        if self._worn is not None and now_ns >= START_NS + self._worn[1] * DAY_S * NS_PER_S:
            self._press.wear_out(self._worn[0], self._worn[2] * DAY_S)
            self._worn = None
        if self._days is not None:
            return now_ns < START_NS + self._days * DAY_S * NS_PER_S
        return self._press.cycles < self._cycles

    def happenings(self) -> tuple[Happening, ...]:
        """All that has happened, failures with their alarms."""
        failures = [
            Happening(label.time_ns, "failure", label.number, label.shown_ns)
            for label in self._press.labels()
        ]
        return tuple(sorted([*self._happened, *failures], key=lambda each: each.time_ns))


def write_truth(path: Path, happenings: tuple[Happening, ...], now_ns: int, cycles: int) -> None:
    """What happened, beside the log it happened in."""
    days = (now_ns - START_NS) / NS_PER_S / DAY_S
    told = {"days": days, "cycles": cycles, "happenings": [asdict(each) for each in happenings]}
    path.write_text(json.dumps(told, indent=1), encoding="utf-8")


def with_truth(log: Log, path: Path) -> Days:
    """A log with what `write_truth` wrote of it."""
    told = json.loads(path.read_text(encoding="utf-8"))
    happenings = tuple(Happening(**each) for each in told["happenings"])
    return Days(log, happenings, told["days"], told["cycles"])


def operation(name: str, *, seed: int, **what: Any) -> Days:
    """A stretch of operation as a logger inside the PLC would write it; `what` is a `Plan`'s."""
    path = FOLDER / f"{name}.parquet"
    truth = path.with_suffix(".json")
    if not (path.is_file() and truth.is_file()):
        press = RunningPress(START_NS, seed)
        plan = Plan(press, seed=seed, **what)
        log = ImageLog(press, START_NS)
        now_ns = START_NS
        while plan.follow(now_ns):
            now_ns += SLICE_NS
            press.advance(now_ns)
        run = log.run(now_ns, [symbol.name for symbol in SYMBOLS])
        FOLDER.mkdir(parents=True, exist_ok=True)
        Log.from_columns(run.time_ns, run.signal_index, run.value, run.signals).write(path)
        write_truth(truth, plan.happenings(), now_ns, press.cycles)
    return with_truth(read_log(path), truth)


LEARNED_FAILURES = (1, 8, 14, 19, 22)
"""Seen once each in what is learned from: cleaning takes them out, and once is no habit."""


def learned_from(cycles: int = 7_000, stops: tuple[str, ...] = LEARNED_STOPS) -> Days:
    """What is learned from: mostly sound, with a few failures and stops that cleaning takes out."""
    name = f"learned-{cycles}" + ("" if stops else "-without-stops")
    return operation(name, seed=1, cycles=cycles, failures=LEARNED_FAILURES, normal=stops)


def fifteen_days(seed: int = WORKED_OUT_ON) -> Days:
    """Table 3: fifteen days, 24 failures, 54 normal stops and variations."""
    return operation(
        f"fifteen-days-{seed}", seed=seed, days=15.0, failures=tuple(FAULTS), normal=NORMAL
    )


def sound_month() -> tuple[Days, ...]:
    """Thirty days without a failure, with twice the stops and variations, in two halves."""
    return tuple(
        operation(f"sound-days-{seed}", seed=seed, days=15.0, normal=NORMAL) for seed in (3, 5)
    )


def manual_returns(number: int = 200) -> Days:
    """An operator takes the machine into manual every few cycles."""
    return operation(f"manual-{number}", seed=4, cycles=number * 4, normal=("manual",) * number)


WORN = ("Clamp2", "Clamp5", "Stop1", "Slide1")
WORN_FROM_DAY, WORN_DAYS = 1.0, 1.0


def wearing_out(device: str | None) -> Days:
    """Two days of sound operation, in the second of which an end cushion wears out; None: none.

    Ends some hours after the cushion has failed.
    """
    name = f"worn-{device.lower()}" if device else "worn-nothing"
    worn = None if device is None else (device, WORN_FROM_DAY, WORN_DAYS)
    return operation(name, seed=7, days=WORN_FROM_DAY + WORN_DAYS + 0.2, worn=worn)
