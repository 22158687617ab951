"""What will happen in a simulated plant, in time order. Simulated time only: no wall clock."""

import heapq
from collections.abc import Callable
from dataclasses import dataclass, field

Action = Callable[[], None]

NS_PER_S = 1_000_000_000


def nanoseconds(seconds: float) -> int:
    """Seconds as whole nanoseconds."""
    return round(seconds * NS_PER_S)


@dataclass(order=True, slots=True)
class Appointment:
    """One thing that will happen, unless it is cancelled."""

    time_ns: int
    sequence: int
    action: Action | None = field(compare=False)

    def cancel(self) -> None:
        """It will not happen."""
        self.action = None


class Agenda:
    """A queue of appointments; those of one time keep the order in which they were made."""

    def __init__(self, now_ns: int) -> None:
        self.now_ns = now_ns
        self._queue: list[Appointment] = []
        self._made = 0

    def after(self, delay_ns: int, action: Action) -> Appointment:
        """Makes an appointment `delay_ns` from now."""
        appointment = Appointment(self.now_ns + max(delay_ns, 0), self._made, action)
        self._made += 1
        heapq.heappush(self._queue, appointment)
        return appointment

    def next_ns(self) -> int | None:
        """Time of the next appointment; None if nothing will happen by itself."""
        while self._queue and self._queue[0].action is None:
            heapq.heappop(self._queue)
        return self._queue[0].time_ns if self._queue else None

    def advance(self, now_ns: int) -> None:
        """Lets everything up to and including `now_ns` happen."""
        while (due_ns := self.next_ns()) is not None and due_ns <= now_ns:
            appointment = heapq.heappop(self._queue)
            self.now_ns = due_ns
            if appointment.action is not None:
                appointment.action()
        self.now_ns = max(self.now_ns, now_ns)
