"""The benches' own clusterings: CSk-means equals the reference, nothing beats the optimum."""

import ctypes
import random
import shutil
from itertools import combinations

import numpy as np
import pytest

from benches.clustering import Clusterings, Instances, instances
from benches.plants import bodyshop
from tests.reference import plat

pytestmark = pytest.mark.skipif(
    not (shutil.which("gcc") and shutil.which("make")), reason="needs gcc and make"
)

K = 5


def some_instances(count: int) -> list[list[float]]:
    chance = random.Random(7)
    return [
        sorted(
            round(chance.choice([5.0, 9.0, 30.0]) + chance.gauss(0, chance.choice([0.1, 3])), 2)
            for _ in range(chance.randint(6, 40))
        )
        for _ in range(count)
    ]


def together(times: list[list[float]]) -> Instances:
    offsets = np.cumsum([0, *(len(each) for each in times)])
    return Instances(np.concatenate(times), offsets, np.ones(len(times), dtype=np.bool_))


class Found(ctypes.Structure):
    _fields_ = (
        ("count", ctypes.c_int),
        ("centre", ctypes.c_double * 16),
        ("size", ctypes.c_int * 16),
    )


def test_merging_leaves_as_many_clusters_as_the_reference() -> None:
    times = some_instances(200)
    parameters = plat.Parameters(span_s=0.0, support=-1.0)
    expected = sum(len(plat.time_clusters(each, parameters)) for each in times)
    assert Clusterings(together(times), K, 3).cluster_and_merge(20.0) == expected


def optimal_cost(times: list[float], k: int) -> float:
    """By trying every cut."""

    def spread(part: list[float]) -> float:
        mean = sum(part) / len(part)
        return sum((time - mean) ** 2 for time in part)

    return min(
        sum(
            spread(times[low:high])
            for low, high in zip((0, *cuts), (*cuts, len(times)), strict=True)
        )
        for cuts in combinations(range(1, len(times)), k - 1)
    )


def test_the_optimum_is_the_best_of_all_cuts() -> None:
    times = [each[:12] for each in some_instances(40)]
    clusterings = Clusterings(together(times), K, 3)
    clusterings.find_optima()
    optima = (Found * (len(times) * K)).from_buffer(clusterings.optima)
    for number, each in enumerate(times):
        for k in range(1, min(K, len(each)) + 1):
            found = optima[number * K + k - 1]
            sizes = list(found.size)[:k]
            ends = np.cumsum([0, *sizes]).tolist()
            assert ends[-1] == len(each)
            cost = sum(
                (time - found.centre[cluster]) ** 2
                for cluster in range(k)
                for time in each[ends[cluster] : ends[cluster + 1]]
            )
            assert cost == pytest.approx(optimal_cost(each, k), abs=1e-6)


def test_a_plant_has_transitions_of_both_kinds() -> None:
    found = instances(bodyshop("tiny", 1))
    assert len(found) > 50
    assert 0 < found.own.sum() < len(found)
    for low, high in zip(found.offsets, found.offsets[1:], strict=False):
        own = found.times_s[low:high]
        assert (np.diff(own) >= 0).all()
        assert own[-1] - own[0] >= 3.0
