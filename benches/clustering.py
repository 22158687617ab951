"""Figures 17, 22 and 23 of Ghosh 2016: how near clusterings come to the optimum, at what cost."""

import ctypes
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from benches.native import library
from benches.options import Options
from benches.plants import Bodyshop
from benches.stopwatch import Stopwatch
from benches.tables import Table, share, verdict
from runglight.plants.run import PlantRun

CLOSE_S = 0.6
"""The paper's "close to global optima"."""
MERGE_S = 3.0
SINGLE_CLUSTER_SPAN_S = 3.0
EPSILONS = tuple(range(1, 25))
SHOWN_EPSILONS = ("1", "2", "4", "8", "12", "16", "20", "24")
RECOMMENDED_EPSILON = 20
CLUSTERS = {"main": (5,), "a": (6, 7, 8), "b": (6, 7, 8), "tiny": (5,)}
"""The values of k the paper shows for each of its databases."""
SEEDINGS = {"k_means_even": -1, "k_means_drawn": -2}
"""k-means: seeds evenly spread over the sorted times, or drawn from them uniformly."""
METHODS = {
    "csk_means": "CSk-means",
    "k_means_even": "k-means, seeds evenly spread",
    "k_means_drawn": "k-means, seeds drawn",
}
UNRESTRICTED = 16
REPEAT = 5

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]
Flags = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Instances:
    """The times of many transitions, sorted within each."""

    times_s: Floats
    offsets: Integers
    own: Flags
    """Per transition: timed by its device's own last event, not by another device or a part."""

    def __len__(self) -> int:
        return len(self.offsets) - 1

    def only(self, chosen: Flags) -> "Instances":
        """Some of the transitions."""
        counts = np.diff(self.offsets)
        offsets = np.concatenate(([0], np.cumsum(counts[chosen])))
        return Instances(self.times_s[np.repeat(chosen, counts)], offsets, self.own[chosen])


def instances(plant: Bodyshop) -> Instances:
    """The transitions of all devices and groups that Algorithm 1 clusters: span from 3 s."""
    run = plant.run.learn
    device, group = _places(run)
    starting = np.isin(run.signal_index, _starting(run, device))
    own_codes = _own_codes(plant)
    times, own = [], []
    for code, elapsed in _transitions(run, device, np.ones_like(starting)):
        times.append(elapsed)
        own.append(code in own_codes)
    for _, elapsed in _transitions(run, group, starting):
        times.append(elapsed)
        own.append(False)
    offsets = np.concatenate(([0], np.cumsum([len(each) for each in times])))
    return Instances(np.concatenate(times), offsets.astype(np.int64), np.array(own))


def _places(run: PlantRun) -> tuple[Integers, Integers]:
    """Device and group of each signal, numbered."""
    names = [name.split("-", 2) for name in run.signals]
    devices = np.unique([f"{group}-{device}" for group, device, _ in names], return_inverse=True)
    groups = np.unique([group for group, _, _ in names], return_inverse=True)
    return devices[1].astype(np.int64), groups[1].astype(np.int64)


def _starting(run: PlantRun, device: Integers) -> Integers:
    """The first signal of each device in the log."""
    _, first = np.unique(device[run.signal_index], return_index=True)
    return run.signal_index[first].astype(np.int64)


def _transitions(run: PlantRun, place: Integers, chosen: Flags) -> Iterator[tuple[int, Floats]]:
    """Code and sorted times of each transition that spans enough."""
    rows = np.flatnonzero(chosen)
    places = place[run.signal_index[rows]]
    order = np.argsort(places, kind="stable")
    rows, places = rows[order], places[order]
    state = 2 * run.signal_index[rows].astype(np.int64) + run.value[rows]
    same = places[1:] == places[:-1]
    code = (state[:-1] * 2 * len(run.signals) + state[1:])[same]
    elapsed_s = np.diff(run.time_ns[rows])[same] / 1e9
    order = np.lexsort((elapsed_s, code))
    code, elapsed_s = code[order], elapsed_s[order]
    bounds = np.flatnonzero(np.diff(code)) + 1
    starts, ends = np.concatenate(([0], bounds)), np.concatenate((bounds, [len(code)]))
    wide = elapsed_s[ends - 1] - elapsed_s[starts] >= SINGLE_CLUSTER_SPAN_S
    for start, end in zip(starts[wide].tolist(), ends[wide].tolist(), strict=True):
        yield int(code[start]), elapsed_s[start:end]


def _own_codes(plant: Bodyshop) -> set[int]:
    signals = plant.run.learn.signals
    number = {
        f"{name}_{ending}": 2 * signal + value
        for signal, name in enumerate(signals)
        for value, ending in enumerate(("OFF", "ON"))
    }
    return {
        number[current] * 2 * len(signals) + number[following]
        for (current, following), after in plant.after.items()
        if after == "device"
    }


class Clusterings:
    """The compiled clusterings of the same transitions, up to k clusters each.

    `most` is how many times a transition truly has at most.
    """

    def __init__(self, of: Instances, k: int, most: int) -> None:
        self._library = library("time_clusters")
        self._library.bytes_of_clusters.restype = ctypes.c_int64
        self._library.cluster_and_merge.restype = ctypes.c_int64
        self._of, self._k, self._most = of, k, most
        bytes_each = self._library.bytes_of_clusters()
        self.optima = np.zeros(len(of) * k * bytes_each, dtype=np.uint8)
        self.chosen = np.zeros(len(of), dtype=np.int32)

    def find_optima(self) -> None:
        """The optimum for each number of clusters; `chosen` is what BIC makes of them."""
        self._library.find_optima(*self._data(), self._k, _at(self.optima), _at(self.chosen))

    def cluster_and_merge(self, epsilon: float) -> int:
        """CSk-means and merging; the number of clusters left."""
        left: int = self._library.cluster_and_merge(
            *self._data(), self._k, ctypes.c_double(epsilon), ctypes.c_double(MERGE_S)
        )
        return left

    def compare(self, epsilon: float, *, restricted: bool = False) -> dict[str, Any]:
        """CSk-means (with one of `SEEDINGS`: k-means) against the optimum."""
        counts = np.zeros(8, dtype=np.int64)
        self._library.compare(
            *self._data(),
            self._k,
            ctypes.c_double(epsilon),
            ctypes.c_double(MERGE_S),
            self._most if restricted else UNRESTRICTED,
            ctypes.c_double(CLOSE_S),
            _at(self.optima),
            _at(counts),
        )
        clusters, off, far, merged, merged_off, merged_far, rounds, transitions = counts.tolist()
        return {
            "clusters": clusters,
            "off": off,
            "far": far,
            "merged": merged,
            "merged_off": merged_off,
            "merged_far": merged_far,
            "rounds": rounds / max(transitions, 1),
        }

    def _data(self) -> tuple[Any, Any, ctypes.c_int64]:
        return _at(self._of.times_s), _at(self._of.offsets), ctypes.c_int64(len(self._of))


def _at(array: npt.NDArray[Any]) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)


def measure(options: Options) -> dict[str, Any]:
    """One entry per plant and k."""
    epsilons = options.few(EPSILONS, (2, RECOMMENDED_EPSILON))
    return {size: _measure_plant(options.bodyshop(size), epsilons) for size in options.sizes}


def _measure_plant(plant: Bodyshop, epsilons: tuple[int, ...]) -> dict[str, Any]:
    everything = instances(plant)
    own = everything.only(everything.own)
    size = plant.run.size
    of_k: dict[str, Any] = {}
    for k in CLUSTERS[size.name]:
        of_k[str(k)] = {
            name: _compare(Clusterings(chosen, k, size.types), epsilons)
            for name, chosen in (("all", everything), ("own", own))
        }
    return {
        "transitions": len(everything),
        "instances": len(everything.times_s),
        "own_transitions": len(own),
        "own_instances": len(own.times_s),
        "times_at_most": size.types,
        "k": of_k,
    }


def _compare(clusterings: Clusterings, epsilons: tuple[int, ...]) -> dict[str, Any]:
    exact, published = Stopwatch(), Stopwatch()
    for _ in range(REPEAT):
        exact.time(clusterings.find_optima)
        published.time(lambda: clusterings.cluster_and_merge(RECOMMENDED_EPSILON))
    return {
        "csk_means": {str(epsilon): clusterings.compare(epsilon) for epsilon in epsilons},
        "methods": {
            method: {
                "merged_while_near": clusterings.compare(way),
                "merged_to_the_true_number": clusterings.compare(way, restricted=True),
            }
            for method, way in {"csk_means": RECOMMENDED_EPSILON, **SEEDINGS}.items()
        },
        "exact_s": exact.best,
        "published_s": published.best,
    }


def figures(results: dict[str, Any]) -> list[dict[str, Any]]:
    """What was demanded, at the largest k of each plant."""
    found = []
    for size, plant in results.items():
        of_k = list(plant["k"].values())[-1]
        merged = of_k["own"]["methods"]["csk_means"]["merged_while_near"]
        far = merged["merged_far"] / max(merged["merged"], 1)
        slower = of_k["all"]["exact_s"] / of_k["all"]["published_s"]
        found += [
            {"plant": size, "what": "CSk-means and merging: clusters over 0.6 s off the optimum",
             "value": f"{100 * far:.2f} %", "demand": "0 %", "met": far == 0},
            {"plant": size, "what": "exact clustering: its time to that of CSk-means and merging",
             "value": f"{slower:.2f} x", "demand": "≤ 1 x", "met": slower <= 1},
        ]  # fmt: skip
    return found


def tables(results: dict[str, Any]) -> list[Table]:
    """At the paper's ε, over ε, and the time it takes."""
    return [_study(results), _sweep(results), _cost(results)]


def _each_k(results: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any], dict[str, Any]]]:
    for size, plant in results.items():
        for k, of_k in plant["k"].items():
            yield f"{size}, k = {k}", plant, of_k


def _study(results: dict[str, Any]) -> Table:
    rows = []
    for title, _, of_k in _each_k(results):
        for method, noun in METHODS.items():
            cells = []
            for name in ("own", "all"):
                found = of_k[name]["methods"][method]["merged_while_near"]
                strict = of_k[name]["methods"][method]["merged_to_the_true_number"]
                cells += [
                    share(found["off"], found["clusters"]),
                    share(found["far"], found["clusters"]),
                    share(found["merged_far"], found["merged"], 2),
                    share(strict["merged_far"], strict["merged"], 2),
                ]
            rounds = of_k["all"]["methods"][method]["merged_while_near"]["rounds"]
            rows.append([title, noun, *cells, f"{rounds:.2f}"])
    of_which = ["off", f"over {CLOSE_S} s", "merged", "merged to the true number"]
    return Table(
        f"Clusters off the optimum (ε = {RECOMMENDED_EPSILON}): timed by themselves, then all",
        ["plant", "method", *of_which, *of_which, "rounds"],
        rows,
        left=2,
    )


def _sweep(results: dict[str, Any]) -> Table:
    columns, cells = ["ε"], {epsilon: [epsilon] for epsilon in SHOWN_EPSILONS}
    for title, _, of_k in _each_k(results):
        columns += [f"{title}: far", "merged"]
        for epsilon, found in of_k["own"]["csk_means"].items():
            if epsilon in cells:
                cells[epsilon] += [
                    share(found["far"], found["clusters"]),
                    share(found["merged_far"], found["merged"], 2),
                ]
    rows = [row for row in cells.values() if len(row) == len(columns)]
    return Table("CSk-means over ε, transitions timed by themselves", columns, rows)


def _cost(results: dict[str, Any]) -> Table:
    rows = [
        [
            title,
            f"{1e6 * of_k['all']['published_s'] / plant['transitions']:.2f}",
            f"{1e6 * of_k['all']['exact_s'] / plant['transitions']:.2f}",
            f"{of_k['all']['exact_s'] / of_k['all']['published_s']:.2f}",
            verdict(of_k["all"]["exact_s"] <= of_k["all"]["published_s"]),
        ]
        for title, plant, of_k in _each_k(results)
    ]
    return Table(
        "Processor time per transition, µs, both in C",
        ["plant", "CSk-means and merging", "exact, for every k", "ratio", "at most as long"],
        rows,
    )
