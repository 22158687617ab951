"""Which address means what: what an identification has to find, and may not know."""

from dataclasses import dataclass

from runglight.plants.bottling.scene import Happening


@dataclass(frozen=True, slots=True)
class Meaning:
    """Something that can be seen at the machine, and where its PLC keeps it."""

    name: str
    seen_as: frozenset[Happening]
    """What somebody declares who watches for it."""
    copies: tuple[str, ...]
    """Addresses that change in the same scans, always."""
    same_thing: tuple[str, ...] = ()
    """Addresses that tell it too, but not in every scan the same."""

    @property
    def addresses(self) -> frozenset[str]:
        """Every right answer."""
        return frozenset(self.copies) | frozenset(self.same_thing)


PARTS = Meaning(
    name="bottles produced",
    seen_as=frozenset({Happening.BOTTLE_LEAVES}),
    # The order's counter counts down, in the same scans.
    copies=("%MW32", "%MW33", "%MW35", "%MW36"),
    # Begins anew every minute; its lowest bit turns with every bottle, as those of the others do.
    same_thing=("%MW128", "%MW128.0"),
)

CONVEYOR = Meaning(
    name="conveyor runs",
    seen_as=frozenset({Happening.CONVEYOR_STARTS, Happening.CONVEYOR_STOPS}),
    copies=("%MW74.0", "%M30", "%MW14.2"),
    # The contactor's own sensor, some hundredths of a second later.
    same_thing=("%MW140.8",),
)

MEANINGS = (PARTS, CONVEYOR)
