"""How large a body shop is: the three plants of Ghosh 2016, and one for tests."""

from dataclasses import dataclass
from itertools import accumulate, pairwise

MINUTE_MS = 60_000


@dataclass(frozen=True, slots=True)
class Size:
    """What a plant has in total, and how long its takt is at least.

    `rules` is what the paper's tool learned of it: the generator comes near. `type_shares` are the
    shares of the part types; a transition has at most as many times as there are part types.
    """

    name: str
    signals: int
    devices: int
    groups: int
    learn_events: int
    watch_events: int
    rules: int
    type_shares: tuple[float, ...]
    shortest_takt_ms: int

    @property
    def types(self) -> int:
        """Number of part types."""
        return len(self.type_shares)

    @property
    def devices_of_groups(self) -> tuple[int, ...]:
        """Devices of each group: as even as can be."""
        bounds = [self.devices * group // self.groups for group in range(self.groups + 1)]
        return tuple(after - before for before, after in pairwise(bounds))

    @property
    def type_bounds(self) -> tuple[float, ...]:
        """Upper bounds of the part types on a scale from 0 to 1, without the last."""
        return tuple(accumulate(self.type_shares))[:-1]


SIZES = {
    size.name: size
    for size in (
        # Ghosh 2016, section 3.2
        Size("main", 21_960, 1_620, 6, 3_320_000, 1_000_000, 50_567, (0.6, 0.4), 60 * MINUTE_MS),
        # the same, appendix: Database A and Database B
        Size("a", 14_467, 1_127, 4, 2_700_000, 1_000_000, 33_394, (0.5, 0.3, 0.2), 60 * MINUTE_MS),
        Size("b", 13_896, 973, 4, 2_450_000, 1_000_000, 31_976, (0.5, 0.3, 0.2), 60 * MINUTE_MS),
        Size("tiny", 260, 20, 2, 38_000, 12_000, 600, (0.6, 0.4), 12 * MINUTE_MS),
    )
}
