"""The net beside the live machine: tokens, the learned controller's shadow, what may come next.

It is given what the page's own tap has read. It has no connection of its own, and no way to write.
"""

from __future__ import annotations

import time
from collections import deque
from typing import TYPE_CHECKING

import msgspec

from runglight.errors import RunglightError
from runglight.process.foretelling import chances
from runglight.process.openings import changes_of
from runglight.process.token_walk import Step, TokenWalk
from runglight.server.process.activities import LiveActivities
from runglight.taps.base import Gap

if TYPE_CHECKING:
    from runglight.server.live_feed import LiveFeed
    from runglight.server.process.opened import OpenedProcess
    from runglight.taps.base import Batch, TapSignal

STEPS_KEPT = 300
DISAGREEMENTS_KEPT = 200
SLOW_S = 0.3
SLOW_TIMES = 3
"""Batches that took so much of the processor: a net that is too large must not hold up alarms."""
RUN_KEPT = 5_000
"""Events of one run that are kept to be counted."""


class LiveStep(msgspec.Struct, frozen=True):
    """One event, as it came."""

    number: int
    time_ms: float
    activity: str
    step: Step
    opens: bool


class OutputNow(msgspec.Struct, frozen=True):
    """One output: what the PLC writes, and what the learned controller would."""

    signal: str
    plc: int | None
    learned: int | None


class Now(msgspec.Struct, frozen=True):
    """What comes next, as the learned controller sees it."""

    waits_for: list[str]
    sets: str | None
    """The activity it would set; None while it waits."""
    after_s: float
    why: str | None
    """`guard`, `only`; None where several are possible and nothing decides."""
    may_set: list[str]


class Beside:
    """One process beside one live feed; `take` is called with every batch."""

    def __init__(self, process: OpenedProcess, feed: LiveFeed, names: dict[str, str]) -> None:
        """`names` says what the net calls a tap's signal, by its name or address."""
        self.feed = feed
        self.process = process
        self._names = names
        self._numbers: list[str | None] = []
        self._walk = TokenWalk(process.net)
        self._classes = _classes(process)
        self._activities = LiveActivities(self._name_of, self._classes)
        self._reset = set(changes_of(process.reset)) if process.reset else set()
        self._decisions = process.decisions()
        self._transitions = process.net.transitions
        self._shadow = None if process.no_controller else process.shadow()
        self._terminals = [] if self._shadow is None else [n for n, _ in self._shadow.terminals]
        self._outputs = [name for name, kind in self._classes.items() if kind == "output"]
        self._learned: dict[str, int] = {}
        self._fired: list[int] | None = None
        self._run: list[tuple[int, str]] = []
        self._chances: tuple[int, list[tuple[str, float]]] = (-1, [])
        self.steps: deque[LiveStep] = deque(maxlen=STEPS_KEPT)
        self.disagreements: deque[str] = deque(maxlen=DISAGREEMENTS_KEPT)
        self.problem: str | None = process.no_controller
        """Why no learned controller looks on."""
        self.given_up = False
        """Whether the net is too large to be followed."""
        self._slow = 0
        self.told = 0
        self.runs = 0
        self.since_ns: int | None = None
        self._number = 0
        self.placed = self._walk.anywhere()
        """Whether tokens can be shown before a run opens: one event mostly tells where they are."""
        self._learn_values()

    @property
    def sure(self) -> bool:
        """Whether it is known where the tokens are."""
        return self.placed and self._walk.sure

    @property
    def missing(self) -> list[str]:
        """Signals of the net that the machine does not have."""
        self._name_all()
        there = set(self._numbers)
        return [name for name in self._classes if name not in there]

    def take(self, batch: Batch) -> None:
        """Follows a batch; gives up where that holds up whoever watches."""
        if self.given_up:
            return
        began_s = time.thread_time()
        self._take(batch)
        self._slow += time.thread_time() - began_s > SLOW_S
        self.given_up = self._slow >= SLOW_TIMES

    def _take(self, batch: Batch) -> None:
        if self.since_ns is None:
            self.since_ns = batch.until_ns
        if any(isinstance(mark, Gap) for mark in batch.marks):
            self._lose()
            if self._shadow is not None:
                self._shadow.gap()
        scanned_ns = None
        for time_ns, activities in self._activities.take(batch):
            for activity in activities:
                self._follow(time_ns, activity)
            self._scan(time_ns)
            scanned_ns = time_ns
        if scanned_ns is None or scanned_ns < batch.until_ns:
            self._scan(batch.until_ns)

    def now(self) -> Now | None:
        """What may come; None while it is not known where the machine stands."""
        if not self.sure:
            return None
        possible = [self._transitions[number] for number in self._walk.enabled()]
        outputs = [each for each in possible if each.signal_class == "output"]
        inputs = list(dict.fromkeys(each.label or "" for each in possible if each not in outputs))
        may_set = list(dict.fromkeys(each.label or "" for each in outputs))
        decided = None
        if self._decisions is not None:
            decided = self._decisions.at(self._walk.marking, self._fired)
        if decided == "wait":
            return Now(inputs, None, 0.0, "guard", may_set)
        if isinstance(decided, tuple):
            number, after_s = decided
            return Now(inputs, self._transitions[number].label, after_s, "guard", may_set)
        if decided is None and len(may_set) == 1 and not inputs:
            return Now(inputs, may_set[0], 0.0, "only", may_set)
        return Now(inputs, None, 0.0, None if may_set else "only", may_set)

    def outputs(self, now: Now | None) -> list[OutputNow]:
        """Every output as the PLC has it, and as the learned controller would."""
        learned = dict(self._learned)
        if now is not None and now.sets is not None and not now.after_s:
            learned |= _values(now.sets)
        known = self.sure
        return [
            OutputNow(name, self._activities.values.get(name), learned.get(name) if known else None)
            for name in self._outputs
        ]

    @property
    def follows(self) -> bool:
        """Whether the shadow knows where the plant stands."""
        return self._shadow is not None and self._shadow.following

    def marking(self) -> dict[int, int]:
        """Tokens by place."""
        return self._walk.marking

    def chances(self) -> list[tuple[str, float]]:
        """What comes next by the network, the likeliest first. Writes a file: for a thread."""
        if self.process.network is None or self._fired is None:
            return []
        number, run = self._number, list(self._run)
        if self._chances[0] != number:
            try:
                self._chances = (number, chances(self.process.network, run))
            except (RunglightError, OSError):
                self._chances = (number, [])
        return self._chances[1]

    def _follow(self, time_ns: int, activity: str) -> None:
        opens = self._opens(activity)
        if opens:
            self._walk.restart()
            self.placed = True
            self._fired, self._run = [], []
            self.runs += 1
        elif not self.placed:
            return
        elif not self._walk.sure and not self._walk.allows(activity):
            # It was looked for where it cannot have been: nothing has departed yet.
            self._lose()
            return
        step = self._walk.step(activity)
        self._walk.forget()
        if self._fired is not None:
            self._fired += step.fired[-1:]
            self._run.append((time_ns, activity))
            if len(self._run) > RUN_KEPT:
                # Nobody counts so far: the run has lost its end.
                self._fired, self._run = None, []
        if not step.departs:
            self._learned |= {
                name: value for name, value in _values(activity).items() if name in self._outputs
            }
        self._number += 1
        self.steps.append(LiveStep(self._number, time_ns / 1e6, activity, step, opens))

    def _opens(self, activity: str) -> bool:
        if self._reset:
            return self._reset <= set(changes_of(activity))
        # A net without a recording does not say what opens a run: what can only be its beginning.
        return self._walk.opens(activity) and not self._walk.allows(activity)

    def _scan(self, time_ns: int) -> None:
        if self._shadow is None:
            return
        values = [self._activities.values.get(name) for name in self._terminals]
        if None in values:
            return
        try:
            lines = self._shadow.scan(time_ns, values).json_lines()
        except RunglightError as error:
            self._shadow, self.problem = None, str(error)
            return
        self.told += len(lines)
        self.disagreements.extend(lines)

    def _lose(self) -> None:
        self.placed = self._walk.anywhere()
        self._fired, self._run = None, []

    def _name_of(self, index: int) -> str | None:
        if index >= len(self._numbers):
            self._name_all()
        return self._numbers[index]

    def _name_all(self) -> None:
        signals = self.feed.tap.signals
        for signal in signals[len(self._numbers) :]:
            self._numbers.append(self._called(signal))

    def _called(self, signal: TapSignal) -> str | None:
        for name in (signal.name, signal.address):
            for called in (name, self._names.get(name)):
                if called in self._classes:
                    return called
        return None

    def _learn_values(self) -> None:
        """As the feed has them already."""
        for index in range(len(self.feed.tap.signals)):
            name, told = self._name_of(index), self.feed.value(index)
            if name is not None and told is not None:
                self._activities.values[name] = told[1]
        values = self._activities.values
        self._learned = {name: values[name] for name in self._outputs if name in values}


def _classes(process: OpenedProcess) -> dict[str, str | None]:
    """The class of each signal of a net."""
    found: dict[str, str | None] = {}
    labelled = [
        (each.label, each.signal_class)
        for each in process.net.transitions
        if each.label is not None
    ]
    if process.runs is not None:
        labelled += process.runs.log.activities
    for label, kind in labelled:
        for change in changes_of(label):
            name, equals, _ = change.rpartition("=")
            if equals:
                found.setdefault(name, kind)
    return found


def _values(activity: str) -> dict[str, int]:
    found: dict[str, int] = {}
    for change in changes_of(activity):
        name, equals, value = change.rpartition("=")
        if equals and value.removeprefix("-").isdecimal():
            found[name] = int(value)
    return found
