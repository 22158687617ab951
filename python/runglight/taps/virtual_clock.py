"""A clock that runs as fast as the work allows: hours of a machine's time in minutes."""

import asyncio
import heapq
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

TURNS = 10
"""How often all other tasks get their turn, all sleepers asleep, before time goes on.

Enough for work that is handed from task to task, as by `asyncio.wait_for(anext(tap), …)`.
"""
PATIENCE_S = 5.0
"""Real seconds after which time goes on although somebody who takes part is awake."""
HASTE_S = 0.01
BREATH_S = 0.0005
"""Real pause between two looks at somebody who is awake for longer than `HASTE_S`."""

AdvanceListener = Callable[[int], None]


@dataclass(order=True, slots=True)
class _Sleeper:
    wakes_ns: int
    sequence: int
    first: asyncio.Event = field(compare=False)
    """Set when nobody sleeps shorter, or time has become real."""


class VirtualClock:
    """A `Clock` whose time stands still while anybody works, and jumps while all sleep.

    A task takes part from its first `sleep_until` (even of now) until it ends. When all who take
    part are asleep, and every other task has had some turns of the event loop, time jumps to the
    earliest sleeper's moment, never past it; sleepers wake in the order of their moments, those of
    one moment in the order in which they fell asleep. A task that takes part and waits for what
    only time can bring delays this by `patience_s`. `hold` stops time for work that never sleeps.

    After `run_on` time flows as fast as the computer's. For one event loop; `now_ns` may be called
    from any thread.
    """

    def __init__(
        self, start_ns: int, *, turns: int = TURNS, patience_s: float = PATIENCE_S
    ) -> None:
        self._now_ns = start_ns
        self._offset_ns: int | None = None
        self._turns = turns
        self._patience_s = patience_s
        self._queue: list[_Sleeper] = []
        self._slept = 0
        self._asleep: dict[asyncio.Task[object], bool] = {}
        self._holds = 0
        self._listeners: list[AdvanceListener] = []

    def now_ns(self) -> int:
        """The time now."""
        if self._offset_ns is None:
            return self._now_ns
        return time.monotonic_ns() + self._offset_ns

    def take_step_ns(self) -> None:
        """Nobody sets this clock: always None."""
        return

    @property
    def is_real(self) -> bool:
        """Whether time flows as the computer's does."""
        return self._offset_ns is not None

    def on_advance(self, listener: AdvanceListener) -> None:
        """From now on `listener` is told the time whenever it has jumped (or a sleeper wakes)."""
        self._listeners.append(listener)

    def advance_to(self, time_ns: int) -> None:
        """Lets time jump at once, past sleepers too; they wake at their next turn.

        ValueError for a time that has passed, or where time flows by itself.
        """
        if self._offset_ns is not None:
            raise ValueError("time flows by itself since run_on(); it cannot be advanced")
        if time_ns < self._now_ns:
            raise ValueError(f"time never runs backwards: it is {self._now_ns}, not {time_ns}")
        self._now_ns = time_ns
        self._tell()

    def run_on(self) -> None:
        """From now on time flows with the computer's monotonic clock, from where it stands."""
        if self._offset_ns is None:
            self._offset_ns = self._now_ns - time.monotonic_ns()
            for sleeper in self._queue:
                sleeper.first.set()

    @contextmanager
    def hold(self) -> Iterator[None]:
        """Inside, time stands still unless somebody advances it."""
        self._holds += 1
        try:
            yield
        finally:
            self._holds -= 1

    async def sleep_until(self, time_ns: int) -> None:
        """Returns at `time_ns`; at once (after letting others run) where that has passed."""
        task = asyncio.current_task()
        assert task is not None
        if time_ns <= self.now_ns():
            self._asleep.setdefault(task, False)
            await asyncio.sleep(0)
            return
        self._slept += 1
        sleeper = _Sleeper(time_ns, self._slept, asyncio.Event())
        heapq.heappush(self._queue, sleeper)
        self._asleep[task] = True
        self._wake_first()
        try:
            await self._wait(sleeper)
        finally:
            self._asleep[task] = False
            self._queue.remove(sleeper)
            heapq.heapify(self._queue)
            self._wake_first()

    async def _wait(self, sleeper: _Sleeper) -> None:
        while (left_ns := sleeper.wakes_ns - self.now_ns()) > 0:
            if self.is_real:
                await asyncio.sleep(left_ns / 1e9)
                self._tell()
            elif self._queue[0] is not sleeper:
                sleeper.first.clear()
                await sleeper.first.wait()
            else:
                await self._let_others_work()
                if (
                    self._queue[0] is sleeper
                    and self._now_ns < sleeper.wakes_ns
                    and not self.is_real
                ):
                    self.advance_to(sleeper.wakes_ns)

    async def _let_others_work(self) -> None:
        began_s = time.monotonic()
        quiet_turns = 0
        while quiet_turns < self._turns and not self.is_real:
            await asyncio.sleep(0)
            quiet_turns += 1
            if self._holds or self._somebody_awake():
                quiet_turns = 0
                waited_s = time.monotonic() - began_s
                if waited_s > self._patience_s and not self._holds:
                    return
                if waited_s > HASTE_S:
                    await asyncio.sleep(BREATH_S)

    def _somebody_awake(self) -> bool:
        for task in [task for task in self._asleep if task.done()]:
            del self._asleep[task]
        return not all(self._asleep.values())

    def _wake_first(self) -> None:
        if self._queue:
            self._queue[0].first.set()

    def _tell(self) -> None:
        now_ns = self.now_ns()
        for listener in self._listeners:
            listener(now_ns)
