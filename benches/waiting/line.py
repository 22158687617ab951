"""Lines of stations that block one another."""

from dataclasses import dataclass

import simpy

from benches.waiting.plant import GROUPS, STATIONS, Life, Plant


@dataclass(frozen=True)
class LineOptions:
    """What lines differ in."""

    takt_s: tuple[float, float] = (18.0, 40.0)
    part_types: int = 2
    people: bool = False


def lines(plant: Plant, options: LineOptions) -> None:
    """Lines of stations that block one another; two robots share each zone."""
    for group in range(1, GROUPS + 1):
        _Line(plant, f"Line{group}", options).start()


class _Line:
    def __init__(self, plant: Plant, name: str, options: LineOptions) -> None:
        self.plant, self.name, self.options = plant, name, options
        draw = plant.draw
        self.free = [plant.places(1) for _ in range(STATIONS)]
        self.parts = [simpy.Store(plant.clock) for _ in range(STATIONS)]
        self.zones = [plant.places(1) for _ in range(STATIONS // 2)]
        self.work_s = [
            [draw.uniform(5, 14) for _ in range(options.part_types)] for _ in range(STATIONS)
        ]
        self.clamp_s = [draw.uniform(0.4, 1.5) for _ in range(STATIONS)]
        self.travel_s = [draw.uniform(1.5, 4) for _ in range(STATIONS)]

    def start(self) -> None:
        self.plant.starts(self._infeed())
        for station in range(STATIONS):
            self.plant.starts(self._station(station))

    def _infeed(self) -> Life:
        plant, types = self.plant, self.options.part_types
        stopper, passed = f"{self.name}-Infeed-Stopper", f"{self.name}-Infeed-Passed"
        while True:
            yield plant.pause(plant.draw.uniform(*self.options.takt_s))
            yield self.free[0].get(1)
            plant.set(stopper, 1)
            yield plant.moves(0.6, passed)
            plant.set(passed, 1)
            yield plant.moves(0.5, stopper)
            plant.set(stopper, 0)
            yield plant.moves(0.3)
            plant.set(passed, 0)
            self.parts[0].put(0 if plant.draw.random() < 0.6 else plant.draw.randrange(1, types))

    def _station(self, at: int) -> Life:
        plant, name = self.plant, f"{self.name}-St{at + 1}"
        present, run = f"{name}Conv-Present", f"{name}Conv-Run"
        close, closed = f"{name}Clamp-Close", f"{name}Clamp-Closed"
        start, zone, done = (f"{name}Robot-{signal}" for signal in ("Start", "InZone", "Done"))
        while True:
            part = yield self.parts[at].get()
            yield plant.moves(self.travel_s[at], present)
            plant.set(present, 1)
            yield plant.moves(0.05)
            plant.set(close, 1)
            yield plant.moves(self.clamp_s[at], closed)
            plant.set(closed, 1)
            yield plant.moves(0.04)
            plant.set(start, 1)
            yield self.zones[at // 2].get(1)
            yield plant.moves(0.2, zone)
            plant.set(zone, 1)
            yield plant.moves(self.work_s[at][part], zone, self.work_s[at])
            plant.set(zone, 0)
            self.zones[at // 2].put(1)
            yield plant.moves(1.1, done)
            plant.set(done, 1)
            yield plant.moves(0.04)
            plant.set(start, 0)
            yield plant.moves(0.06)
            plant.set(done, 0)
            plant.set(close, 0)
            yield plant.moves(0.8 * self.clamp_s[at], closed)
            plant.set(closed, 0)
            last = at == STATIONS - 1
            if last and self.options.people:
                yield plant.pause(plant.draw.lognormvariate(1.5, 0.5))
                plant.set(f"{name}Desk-Button", 1)
                yield plant.pause(plant.draw.uniform(0.2, 0.6))
                plant.set(f"{name}Desk-Button", 0)
            if not last:
                yield self.free[at + 1].get(1)
            yield plant.moves(0.05, run)
            plant.set(run, 1)
            yield plant.moves(0.9, present)
            plant.set(present, 0)
            yield plant.moves(0.2, run)
            plant.set(run, 0)
            if not last:
                self.parts[at + 1].put(part)
            self.free[at].put(1)
