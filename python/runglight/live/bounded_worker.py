"""A thread that works off what it is given; whoever gives never waits."""

from __future__ import annotations

import threading
from collections import deque
from typing import TYPE_CHECKING, Generic, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable

Item = TypeVar("Item")


class BoundedWorker(Generic[Item]):
    """Does `work` with each item in a thread of its own, in order.

    Where it is slower than what comes, the oldest items are dropped and counted. After an error
    it takes nothing more: `failed` is called with it, in the thread.
    """

    def __init__(
        self,
        name: str,
        work: Callable[[Item], None],
        failed: Callable[[Exception], None],
        *,
        at_most: int,
    ) -> None:
        self._work = work
        self._failed = failed
        self._at_most = at_most
        self._items: deque[Item] = deque()
        self._changed = threading.Condition()
        self._closing = False
        self.dropped = 0
        # A daemon: a terminal that is held (Ctrl-S) must not keep the process from ending.
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)
        self._thread.start()

    def put(self, item: Item) -> None:
        """Hands an item over; returns at once."""
        with self._changed:
            if self._closing:
                return
            if len(self._items) >= self._at_most:
                self._items.popleft()
                self.dropped += 1
            self._items.append(item)
            self._changed.notify()

    def close(self, within_s: float) -> bool:
        """Lets it work off the rest; whether it has ended in time. It takes nothing more."""
        with self._changed:
            self._closing = True
            self._changed.notify()
        self._thread.join(within_s)
        return not self._thread.is_alive()

    def _run(self) -> None:
        while True:
            with self._changed:
                while not self._items:
                    if self._closing:
                        return
                    self._changed.wait()
                item = self._items.popleft()
            try:
                self._work(item)
            except Exception as error:  # The owner decides what an error means.
                with self._changed:
                    self._closing = True
                    self._items.clear()
                self._failed(error)
                return
