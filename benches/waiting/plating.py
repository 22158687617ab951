"""Plating: one hoist for many baths."""

from benches.waiting.plant import GROUPS, STATIONS, Life, Plant


def plating(plant: Plant) -> None:
    """Baths that one hoist serves, whoever asks first."""
    for group in range(1, GROUPS + 1):
        _Plating(plant, f"Plating{group}").start()


class _Plating:
    CARRIERS = 3

    def __init__(self, plant: Plant, name: str) -> None:
        self.plant, self.name = plant, name
        self.hoist = plant.places(1)
        self.free = [plant.places(1) for _ in range(STATIONS)]
        self.soak_s = [plant.draw.uniform(20, 60) for _ in range(STATIONS)]

    def start(self) -> None:
        for _ in range(self.CARRIERS):
            self.plant.starts(self._carrier(self.plant.draw.uniform(0, 60)))

    def _carrier(self, first_s: float) -> Life:
        plant = self.plant
        yield plant.pause(first_s)
        while True:
            for bath in range(STATIONS):
                yield self.free[bath].get(1)
                yield self.hoist.get(1)
                yield from self._carry(bath)
                self.hoist.put(1)
                if bath:
                    self.free[bath - 1].put(1)
                yield from self._soak(bath)
            self.free[-1].put(1)
            yield plant.pause(plant.draw.uniform(5, 40))

    def _carry(self, bath: int) -> Life:
        plant = self.plant
        travel, lower, bottom, top, there = (
            f"{self.name}-Hoist-{signal}"
            for signal in ("Travel", "Lower", "Bottom", "Top", f"At{bath}")
        )
        plant.set(travel, 1)
        yield plant.moves(2.0 + 0.7 * bath, there)
        plant.set(there, 1)
        plant.set(travel, 0)
        plant.set(lower, 1)
        yield plant.moves(3.0, bottom)
        plant.set(bottom, 1)
        plant.set(lower, 0)
        plant.set(f"{self.name}-Bath{bath}-Level", 1)
        yield plant.moves(0.5)
        plant.set(bottom, 0)
        yield plant.moves(2.0, top)
        plant.set(top, 1)
        plant.set(there, 0)
        yield plant.moves(0.2)
        plant.set(top, 0)

    def _soak(self, bath: int) -> Life:
        plant = self.plant
        rectifier, level = (f"{self.name}-Bath{bath}-{signal}" for signal in ("Rectifier", "Level"))
        plant.set(rectifier, 1)
        yield plant.pause(self.soak_s[bath])
        plant.set(rectifier, 0)
        yield plant.moves(0.5, level)
        plant.set(level, 0)
