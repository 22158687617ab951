"""Somebody goes through the photos of a recording and declares what is to be seen on them."""

from random import Random

from benches.bottling_cases import Integers
from runglight.plants.agenda import nanoseconds
from runglight.plants.bottling import Meaning, Sight

MISSED = 0.05
LATE_S = 1.0


def declared(
    sights: tuple[Sight, ...],
    meaning: Meaning,
    photo_ns: Integers,
    seed: int,
    *,
    missed: float = MISSED,
    late_s: float = LATE_S,
    offset_s: float = 0.0,
) -> list[int]:
    """Times of the declared events, nanoseconds, in order.

    What happened is seen on the first photo after it (a belt that has started has moved on it, one
    that has stopped is where it will be on the next), so an event is up to one photo late to begin
    with. On top of that it is declared up to `late_s` late, and with probability `missed` not at
    all; `offset_s` later than that, where the clocks differ. What no photo shows any more is not
    declared.

    The same seed misses what it missed with a smaller share, and is late in proportion.
    """
    random = Random(f"{seed}/{meaning.name}")
    events: list[int] = []
    for sight in sights:
        overlooked, late = random.random() < missed, random.random()
        after = int(photo_ns.searchsorted(sight.time_ns))
        if sight.what not in meaning.seen_as or overlooked or after == len(photo_ns):
            continue
        events.append(int(photo_ns[after]) + nanoseconds(late * late_s + offset_s))
    return sorted(events)
