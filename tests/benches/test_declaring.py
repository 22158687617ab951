"""Somebody who declares what the photos show: late, and not everything."""

import numpy as np

from benches.declaring import declared
from runglight.plants.bottling import CONVEYOR, PARTS, Happening, Sight

S = 1_000_000_000
PHOTOS = np.arange(0, 101 * S, S)
SIGHTS = tuple(
    Sight(round(at_s * S), what)
    for at_s, what in [
        (0.4, Happening.BOTTLE_LEAVES),
        (10.0, Happening.CONVEYOR_STOPS),
        (20.2, Happening.CONVEYOR_STARTS),
        (30.9, Happening.BOTTLE_LEAVES),
        (100.5, Happening.BOTTLE_LEAVES),
    ]
)


def test_an_event_is_seen_on_the_first_photo_after_it() -> None:
    parts = declared(SIGHTS, PARTS, PHOTOS, seed=1, missed=0.0, late_s=0.0)
    assert parts == [1 * S, 31 * S]
    conveyor = declared(SIGHTS, CONVEYOR, PHOTOS, seed=1, missed=0.0, late_s=0.0)
    assert conveyor == [10 * S, 21 * S]
    later = declared(SIGHTS, PARTS, PHOTOS, seed=1, missed=0.0, late_s=0.0, offset_s=2.0)
    assert later == [3 * S, 33 * S]


def test_delays_and_misses_are_as_large_as_asked_for() -> None:
    many = tuple(Sight(round(at * S * 0.1), Happening.BOTTLE_LEAVES) for at in range(1, 1000))
    punctual = declared(many, PARTS, PHOTOS, seed=3, missed=0.0, late_s=0.0)
    late = declared(many, PARTS, PHOTOS, seed=3, missed=0.0, late_s=1.0)
    assert len(punctual) == len(late) == 999
    delays_s = (np.array(late) - np.sort(punctual)) / 1e9
    assert 0.45 < delays_s.mean() < 0.55
    few = declared(many, PARTS, PHOTOS, seed=3, missed=0.3, late_s=0.0)
    assert 650 < len(few) < 750
    fewer = declared(many, PARTS, PHOTOS, seed=3, missed=0.6, late_s=0.0)
    assert set(fewer) <= set(few)
    assert declared(many, PARTS, PHOTOS, seed=4, missed=0.3, late_s=0.0) != few
