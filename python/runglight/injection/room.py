"""Where faults may still go: taken stretches of time, per group and per device."""

from bisect import bisect_right, insort
from collections import defaultdict

Place = tuple[str, int]
"""`("group", 3)` or `("device", 17)`."""


class Room:
    """Stretches that are taken, with `spacing_ns` kept free around each."""

    def __init__(self, spacing_ns: int) -> None:
        self._spacing_ns = spacing_ns
        self._taken: defaultdict[Place, list[tuple[int, int]]] = defaultdict(list)

    def free(self, place: Place, start: int, end: int) -> bool:
        """True where nothing is taken from `start` to `end`, nor near it."""
        taken = self._taken[place]
        at = bisect_right(taken, end + self._spacing_ns, key=lambda stretch: stretch[0])
        return at == 0 or taken[at - 1][1] < start - self._spacing_ns

    def take(self, place: Place, start: int, end: int) -> None:
        """Takes a stretch that is free."""
        insort(self._taken[place], (start, end))
