"""The tank itself: its level, three sensors and two valves (Theis 2019, section VI-A)."""

from collections import deque
from collections.abc import Callable, Sequence

import numpy as np

from runglight.plants.agenda import NS_PER_S, nanoseconds
from runglight.plants.tank.flows import Flows

VOLUME = 100.0
"""Gallons."""
SENSOR_LEVELS = (90.0, 10.0, 50.0)
"""Gallons at which ul, ll and ml begin to feel liquid: the order of `symbols.INPUTS`."""
DRAW_NS = NS_PER_S
"""How often flows are drawn anew."""
VALVE_NS = 100_000_000
"""From a valve's signal to its movement. Without it the sensor that made the PLC act could let go
before anybody who reads the PLC once per scan has seen the act."""

SensorListener = Callable[[int, int, bool], None]
"""Hears a sensor switch: time in nanoseconds, number of the sensor, whether it feels liquid."""


class TankPlant:
    """A `Plant` of the scan cycle. The level is exact between any two draws of the flows."""

    def __init__(
        self,
        start_ns: int,
        seed: int,
        flows: Flows,
        *,
        level: float = 0.0,
        listener: SensorListener | None = None,
    ) -> None:
        self._flows = flows
        self._random = np.random.default_rng([seed, 0x7A6E])
        self._now_ns = start_ns
        self._level = level
        self._listener = listener
        self._open = [False, False]
        self._told = [False, False]
        self._moves: deque[tuple[int, int, bool]] = deque()
        self._sensors = [level >= each for each in SENSOR_LEVELS]
        self._stuck: dict[int, bool] = {}
        self._jammed: dict[int, bool] = {}
        self._drawn_ns = start_ns
        self._in, self._out = flows.draw(self._random), flows.draw(self._random)
        self.spilt = 0.0
        """Gallons that ran over the brim."""
        self.lowest, self.highest = level, level
        """The extremes of the level so far."""

    @property
    def level(self) -> float:
        """Gallons in the tank."""
        return self._level

    def advance(self, now_ns: int) -> None:
        """Lets the liquid flow until `now_ns`."""
        while self._now_ns < now_ns:
            moves_ns = self._moves[0][0] if self._moves else now_ns
            until_ns = min(now_ns, self._drawn_ns + DRAW_NS, moves_ns)
            self._flow(until_ns)
            while self._moves and self._moves[0][0] <= until_ns:
                _, valve, is_open = self._moves.popleft()
                self._open[valve] = self._jammed.get(valve, is_open)
            if until_ns == self._drawn_ns + DRAW_NS:
                self._drawn_ns = until_ns
                self._in = self._flows.draw(self._random)
                self._out = self._flows.draw(self._random)

    def read_inputs(self) -> tuple[bool, ...]:
        """What the sensors report now."""
        return tuple(self._stuck.get(n, felt) for n, felt in enumerate(self._sensors))

    def write_outputs(self, outputs: Sequence[bool]) -> None:
        """Tells the valves what to be: inward, outward. They move `VALVE_NS` later."""
        for valve, value in enumerate(map(bool, outputs)):
            if value != self._told[valve]:
                self._told[valve] = value
                self._moves.append((self._now_ns + VALVE_NS, valve, value))

    def next_event_ns(self) -> int | None:
        """When a sensor switches, a valve moves, or the flows are drawn anew."""
        rate = self._rate()
        times = [] if self._flows.constant else [self._drawn_ns + DRAW_NS]
        times += [moves_ns for moves_ns, _, _ in self._moves]
        for number in range(len(SENSOR_LEVELS)):
            seconds = self._until_switched_s(number, rate)
            if seconds is not None:
                times.append(self._now_ns + nanoseconds(seconds))
        return min(times, default=None)

    def stick(self, sensor: int, value: bool) -> None:
        """From now on a sensor reports `value`."""
        self._report_if_stuck(sensor, value)
        self._stuck[sensor] = value

    def jam(self, valve: int, is_open: bool) -> None:
        """From now on a valve stands open or closed whatever it is told."""
        self._jammed[valve] = is_open
        self._open[valve] = is_open

    def _rate(self) -> float:
        inward, outward = self._in[not self._open[0]], self._out[not self._open[1]]
        return inward - outward

    def _flow(self, until_ns: int) -> None:
        rate = self._rate()
        began_ns, lasting_ns = self._now_ns, until_ns - self._now_ns
        switched = [
            (seconds, number)
            for number in range(len(SENSOR_LEVELS))
            if (seconds := self._until_switched_s(number, rate)) is not None
            and nanoseconds(seconds) <= lasting_ns
        ]
        level = self._level + rate * lasting_ns / NS_PER_S
        self.spilt += max(level - VOLUME, 0.0)
        self._level = min(max(level, 0.0), VOLUME)
        self.lowest = min(self.lowest, self._level)
        self.highest = max(self.highest, self._level)
        self._now_ns = until_ns
        for seconds, number in sorted(switched):
            self._sensors[number] = rate > 0
            if self._listener is not None and number not in self._stuck:
                self._listener(began_ns + nanoseconds(seconds), number, rate > 0)

    def _until_switched_s(self, number: int, rate: float) -> float | None:
        """When a sensor switches if the flows stay; None if it does not."""
        if rate == 0 or self._sensors[number] == (rate > 0):
            return None
        return max((SENSOR_LEVELS[number] - self._level) / rate, 0.0)

    def _report_if_stuck(self, sensor: int, value: bool) -> None:
        if self._listener is not None and self.read_inputs()[sensor] != value:
            self._listener(self._now_ns, sensor, value)
