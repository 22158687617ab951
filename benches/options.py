"""How much is measured."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TypeVar

from benches.plants import Bodyshop, bodyshop

Item = TypeVar("Item")

PLANT_SEED = 1


@dataclass(frozen=True)
class Options:
    """`quick` is for tests: the smallest plant, the fewest seeds, nothing that can be trusted."""

    quick: bool = False

    @cached_property
    def sizes(self) -> tuple[str, ...]:
        """Body shops that are measured."""
        return ("tiny",) if self.quick else ("main", "a", "b")

    @property
    def seeds(self) -> range:
        """Seeds of what is averaged over, as many as in the paper."""
        return range(1, 2 if self.quick else 6)

    @property
    def repeat(self) -> int:
        """Repetitions of what is timed."""
        return 1 if self.quick else 3

    def few(self, everything: Sequence[Item], some: Sequence[Item]) -> tuple[Item, ...]:
        """All, or only some where it must be quick."""
        return tuple(some if self.quick else everything)

    def bodyshop(self, size: str, seed: int = PLANT_SEED) -> Bodyshop:
        """A body shop with the size's own number of events."""
        return _bodyshop(size, seed)


@lru_cache(maxsize=1)
def _bodyshop(size: str, seed: int) -> Bodyshop:
    return bodyshop(size, seed)
