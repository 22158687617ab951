"""Rotary tables: all stations start together, and the slowest is waited for."""

from benches.waiting.plant import GROUPS, STATIONS, Life, Plant


def rotary_tables(plant: Plant) -> None:
    """Tables that turn when the slowest of their stations is done."""
    for group in range(1, GROUPS + 1):
        _Table(plant, f"Table{group}").start()


class _Table:
    PART_TYPES = 2

    def __init__(self, plant: Plant, name: str) -> None:
        self.plant, self.name = plant, name
        draw = plant.draw
        self.go = [plant.places(0) for _ in range(STATIONS)]
        self.done = plant.places(0)
        self.strokes = [draw.randrange(1, 3) for _ in range(STATIONS)]
        self.work_s = [
            [draw.uniform(4, 9) / strokes for _ in range(self.PART_TYPES)]
            for strokes in self.strokes
        ]
        self.parts = [0] * STATIONS

    def start(self) -> None:
        self.plant.starts(self._table())
        for station in range(STATIONS):
            self.plant.starts(self._station(station))

    def _table(self) -> Life:
        plant = self.plant
        rotate, in_position = f"{self.name}-Table-Rotate", f"{self.name}-Table-InPosition"
        while True:
            part_is_there = plant.draw.random() < 0.7
            yield plant.pause(0.1 if part_is_there else plant.draw.uniform(0, 8))
            plant.set(rotate, 1)
            yield plant.moves(0.3, in_position)
            plant.set(in_position, 0)
            yield plant.moves(3.5, in_position)
            plant.set(in_position, 1)
            yield plant.moves(0.05)
            plant.set(rotate, 0)
            self.parts = [plant.draw.randrange(self.PART_TYPES), *self.parts[:-1]]
            for go in self.go:
                go.put(1)
            yield self.done.get(STATIONS)

    def _station(self, at: int) -> Life:
        plant, name = self.plant, f"{self.name}-Unit{at + 1}"
        down, is_down, is_up = (f"{name}-{signal}" for signal in ("Down", "IsDown", "IsUp"))
        on, ready = f"{name}Tool-On", f"{name}Tool-Ready"
        while True:
            yield self.go[at].get(1)
            work_s = self.work_s[at]
            yield plant.moves(0.15, down)
            plant.set(down, 1)
            yield plant.moves(0.8, is_down)
            plant.set(is_down, 1)
            for _ in range(self.strokes[at]):
                plant.set(on, 1)
                yield plant.moves(work_s[self.parts[at]], ready, work_s)
                plant.set(ready, 1)
                yield plant.moves(0.05)
                plant.set(on, 0)
                yield plant.moves(0.3, ready)
                plant.set(ready, 0)
            plant.set(down, 0)
            yield plant.moves(0.1)
            plant.set(is_down, 0)
            yield plant.moves(0.7, is_up)
            plant.set(is_up, 1)
            yield plant.moves(0.2)
            plant.set(is_up, 0)
            self.done.put(1)
