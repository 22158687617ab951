"""The machine makes 400 bottles an hour, and its truth table says what its memory does."""

from collections import defaultdict
from itertools import pairwise
from math import inf

import pytest

from runglight.plants import PLANTS
from runglight.plants.agenda import NS_PER_S
from runglight.plants.bottling import CONVEYOR, MEANINGS, PARTS, SYMBOLS, Happening, RunningBottling
from runglight.plants.bottling.simulate import START_NS, simulate_bottling

Moments = dict[str, tuple[int, ...]]
"""By address, also of bits of words: the times of its changes."""


def moments_of(plant: RunningBottling, seconds: int) -> Moments:
    """Runs the plant; what changes in its first scan is how it stands."""
    moments: dict[str, list[int]] = defaultdict(list)
    values: dict[str, int] = defaultdict(int)

    def hear(time_ns: int, number: int, value: int) -> None:
        address = plant.symbols[number].address
        flipped = values[address] ^ value
        values[address] = value
        if time_ns == START_NS:
            return
        moments[address].append(time_ns)
        if address.startswith("%MW"):
            for bit in range(16):
                if flipped >> bit & 1:
                    moments[f"{address}.{bit}"].append(time_ns)

    plant.on_change(hear)
    plant.advance(START_NS + seconds * NS_PER_S)
    return {address: tuple(times) for address, times in moments.items()}


@pytest.fixture(scope="module")
def moments() -> Moments:
    """Of ten minutes with several manual phases."""
    return moments_of(RunningBottling(START_NS, 3, production_s=80.0), 600)


def test_the_memory_is_that_of_the_paper() -> None:
    addresses = [symbol.address for symbol in SYMBOLS]
    assert addresses == [f"%M{n}" for n in range(100)] + [f"%MW{n}" for n in range(300)]
    assert len({symbol.name for symbol in SYMBOLS}) == 400


def test_it_makes_400_bottles_an_hour() -> None:
    plant = RunningBottling(START_NS, 7, production_s=inf)
    plant.advance(START_NS + 900 * NS_PER_S)
    left = [s.time_ns for s in plant.sights if s.what is Happening.BOTTLE_LEAVES]
    assert 92 <= len(left) <= 106
    # In groups of three or four, one after the other, and a pause between two groups.
    steps_s = [(b - a) / 1e9 for a, b in pairwise(left)]
    assert min(steps_s) > 2.5
    assert not [step for step in steps_s if 4.0 < step < 15.0]


@pytest.mark.parametrize("meaning", MEANINGS, ids=lambda meaning: meaning.name)
def test_copies_change_in_the_same_scans_and_nothing_else_does(
    meaning: type[PARTS], moments: Moments
) -> None:
    first, *others = meaning.copies
    assert len(moments[first]) > 15
    for other in others:
        assert moments[other] == moments[first], other
    same = {address for address, times in moments.items() if times == moments[first]}
    # The lowest bit of a counter turns with every count.
    counters = {f"{address}.0" for address in PARTS.copies}
    assert same - counters == set(meaning.copies)


def test_what_tells_the_same_does_so_nearly_always(moments: Moments) -> None:
    (contactor,) = CONVEYOR.same_thing
    pairs = list(zip(moments["%MW74.0"], moments[contactor], strict=True))
    assert all(0 < later - order <= 80_000_000 for order, later in pairs)
    minute, _ = PARTS.same_thing
    assert set(moments["%MW33"]) <= set(moments[minute])
    assert len(moments[minute]) > len(moments["%MW33"])


def test_what_is_seen_is_what_the_memory_tells() -> None:
    plant = RunningBottling(START_NS, 5, production_s=60.0)
    moments = moments_of(plant, 300)
    moved = [s.time_ns for s in plant.sights if s.what is not Happening.BOTTLE_LEAVES]
    assert len(moved) == len(moments["%MW74.0"])
    assert all(
        0 <= at - order < 100_000_000 for at, order in zip(moved, moments["%M30"], strict=True)
    )
    left = [s.time_ns for s in plant.sights if s.what is Happening.BOTTLE_LEAVES]
    # Counted at the exit, a little after it has visibly left station 2; jogging comes between.
    waiting = [count - at for at, count in zip(left, moments["%MW33"], strict=False)]
    assert abs(len(left) - len(moments["%MW33"])) <= 1
    assert min(waiting) > 0
    assert sorted(waiting)[len(waiting) // 2] < 500_000_000


def test_many_words_move_and_most_never_do(moments: Moments) -> None:
    moving = {address.partition(".")[0] for address in moments}
    assert 80 <= len(moving) <= 120
    assert "%MW40" not in moving
    noise = [address for address, times in moments.items() if len(times) > 1_000]
    assert {"%MW0", "%MW20", "%MW24"} <= set(noise)


def test_the_same_seed_gives_the_same_log_however_it_is_advanced() -> None:
    whole = moments_of(RunningBottling(START_NS, 9), 60)
    stepwise = RunningBottling(START_NS, 9)
    heard: list[int] = []

    def hear(time_ns: int, number: int, _value: int) -> None:
        if number == 133 and time_ns > START_NS:
            heard.append(time_ns)

    stepwise.on_change(hear)
    for step in range(0, 60_000, 7):
        stepwise.advance(START_NS + step * 1_000_000)
        stepwise.scene()
    stepwise.advance(START_NS + 60 * NS_PER_S)
    assert SYMBOLS[133].address == "%MW33"
    assert tuple(heard) == whole["%MW33"]
    assert moments_of(RunningBottling(START_NS, 10), 60) != whole


def test_a_log_calls_signals_by_address_and_begins_with_the_whole_image() -> None:
    assert PLANTS["bottling"].simulate is simulate_bottling
    run = simulate_bottling(3)
    assert run.signals[133] == "%MW33"
    first = run.signal_index[run.time_ns == START_NS]
    assert sorted(first.tolist()) == list(range(400))
    assert run.time_ns[-1] == run.end_ns


def test_what_cannot_be_is_refused() -> None:
    with pytest.raises(ValueError, match="at least 1 bottle"):
        simulate_bottling(0)
    with pytest.raises(ValueError, match="has no faults"):
        simulate_bottling(3, fault=["x"])
    with pytest.raises(ValueError, match="has no faults"):
        RunningBottling(START_NS).inject(1)
