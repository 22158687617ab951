"""The conveyor: bottles ride on it, stops hold them, sensors see them pass."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import ceil

from runglight.plants.agenda import Agenda, Appointment

SPEED_M_PER_S = 0.25
DIAMETER_M = 0.06
END_M = 1.6
"""Where bottles fall into the crate, out of sight."""

_NEAR_M = 1e-9


@dataclass(slots=True, eq=False)
class Bottle:
    """One bottle: where its middle is, and what has been done to it."""

    position_m: float = 0.0
    filled: float = 0.0
    capped: bool = False


@dataclass(frozen=True, slots=True)
class Eye:
    """Sees a bottle whose middle lies from `from_m` up to, not including, `to_m`."""

    from_m: float
    to_m: float

    def sees(self, bottle: Bottle) -> bool:
        """Whether it does."""
        return self.from_m - _NEAR_M <= bottle.position_m < self.to_m - _NEAR_M


class Belt:
    """Moves from mark to mark: between two, every bottle rides or stands.

    `report` hears whenever an eye sees something else than before.
    """

    def __init__(
        self,
        agenda: Agenda,
        stops_m: Mapping[str, float],
        eyes: Mapping[str, Eye],
        report: Callable[[str, bool], None],
    ) -> None:
        self.bottles: list[Bottle] = []
        """The furthest first."""
        self.running = False
        self.travel_m = 0.0
        """How far the belt has moved since the beginning."""
        self._agenda = agenda
        self._stops_m = stops_m
        self._closed = set(stops_m)
        self._eyes = eyes
        self._report = report
        self._seen = dict.fromkeys(eyes, False)
        self._since_ns = agenda.now_ns
        self._next: Appointment | None = None

    def run(self, running: bool) -> None:
        """Starts or stops the motor."""
        self.settle()
        self.running = running
        self._plan()

    def close(self, stop: str, closed: bool) -> None:
        """Moves a stop; a bottle whose middle has passed it goes on."""
        self.settle()
        (self._closed.add if closed else self._closed.discard)(stop)
        self._plan()

    def is_closed(self, stop: str) -> bool:
        """Whether a stop holds bottles."""
        return stop in self._closed

    def place(self, bottle: Bottle) -> bool:
        """Sets a bottle on the beginning of the belt; False where there is no room."""
        self.settle()
        if self.bottles and self.bottles[-1].position_m < DIAMETER_M:
            return False
        self.bottles.append(bottle)
        self._plan()
        return True

    def at(self, position_m: float) -> Bottle | None:
        """The bottle that stands there."""
        for bottle in self.bottles:
            if abs(bottle.position_m - position_m) < DIAMETER_M / 2:
                return bottle
        return None

    def travel_at(self, now_ns: int) -> float:
        """How far the belt will have moved by then, if nothing happens meanwhile."""
        return self.travel_m + self._moved_m(now_ns)

    def positions_at(self, now_ns: int) -> list[float]:
        """Where the bottles will be, metres, if nothing happens meanwhile."""
        moved_m = self._moved_m(now_ns)
        positions_m: list[float] = []
        ahead_m = float("inf")
        for bottle in self.bottles:
            limit_m = max(min(self._stop_m(bottle), ahead_m - DIAMETER_M), bottle.position_m)
            ahead_m = min(bottle.position_m + moved_m, limit_m)
            positions_m.append(ahead_m)
        return positions_m

    def settle(self) -> None:
        """Brings everything up to now."""
        now_ns = self._agenda.now_ns
        travel_m, positions_m = self.travel_at(now_ns), self.positions_at(now_ns)
        self.travel_m, self._since_ns = travel_m, now_ns
        for bottle, position_m in zip(self.bottles, positions_m, strict=True):
            bottle.position_m = position_m
        self.bottles = [each for each in self.bottles if each.position_m < END_M - _NEAR_M]

    def _moved_m(self, now_ns: int) -> float:
        return (now_ns - self._since_ns) * 1e-9 * SPEED_M_PER_S if self.running else 0.0

    def _stop_m(self, bottle: Bottle) -> float:
        """The next closed stop ahead."""
        ahead = (self._stops_m[stop] for stop in self._closed)
        return min((at for at in ahead if at >= bottle.position_m - _NEAR_M), default=float("inf"))

    def _plan(self) -> None:
        if self._next is not None:
            self._next.cancel()
            self._next = None
        self._look()
        if not self.running:
            return
        distances_m = self._distances_m()
        if distances_m:
            delay_ns = max(ceil(min(distances_m) / SPEED_M_PER_S * 1e9), 1)
            self._next = self._agenda.after(delay_ns, self._arrive)

    def _arrive(self) -> None:
        self.settle()
        self._plan()

    def _distances_m(self) -> list[float]:
        """From each bottle that rides to the next place where something changes."""
        distances: list[float] = []
        ahead_m, ahead_rides = float("inf"), True
        for bottle in self.bottles:
            at_m = bottle.position_m
            marks = [self._stop_m(bottle), END_M]
            if not ahead_rides:
                marks.append(ahead_m - DIAMETER_M)
            rides = min(marks) - at_m > _NEAR_M
            if rides:
                marks += [edge for eye in self._eyes.values() for edge in (eye.from_m, eye.to_m)]
                distances.append(min(mark - at_m for mark in marks if mark - at_m > _NEAR_M))
            ahead_m, ahead_rides = at_m, rides
        return distances

    def _look(self) -> None:
        for name, eye in self._eyes.items():
            sees = any(map(eye.sees, self.bottles))
            if sees != self._seen[name]:
                self._seen[name] = sees
                self._report(name, sees)
