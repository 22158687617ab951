"""The sentences of the page; what they say of a number, they read from it."""

from collections.abc import Callable
from typing import Any

from benches.accuracy import PUBLISHED_LATE

HEAD = """<!-- Written by benches/page.py from benchmarks.json; run `make bench`. -->

# Benchmarks

Measured by `make bench`, seeded, on simulated plants and real recordings. Speeds are events per second of
processor time, the best of several repetitions; ratios are of one run, in which all contenders take
turns. `python -m benches.run --publish` writes this page anew; the numbers behind it are in `benchmarks.json`.

"""

NOTES: dict[str, tuple[str, str]] = {
    "throughput": (
        "Speed and memory",
        """The [body shop](bodyshop.md) in its three sizes. `columns` are numpy arrays made a log beforehand, `Arrow` are
tables of 262,144 rows with a dictionary of names. The C++ is `benches/plat_baseline`: the paper's own structures, built as published
(no flags) and with -O3, double hashing, watching the same log in the same order. The plain loop does one load and store in a table
of 64 bytes a signal per event, and nothing else. Memory is what the process grows by, without code, when a
saved model is loaded and a monitor made; `plat` takes the allowances of Table 4.""",
    ),
    "clustering": (
        "Clusterings (Figures 17, 22 and 23)",
        """Transitions of the learning part that Algorithm 1 clusters: their times span at least 3 s. CSk-means and merging (HAC, 3 s) follow
the paper; k-means takes its seeds from the sorted times, evenly spread or drawn; the optimum is found by dynamic
programming, for the same number of clusters. A cluster is far off where its centre lies more than 0.6 s from the
optimum's. `Merged to the true number` goes on merging until at most as many clusters are left as the plant has part types. Times
are of the benches' own C, not of the engine.""",
    ),
    "accuracy": (
        "Detection (Tables 5 and 6)",
        """150 faults of order and 1,500 (`main`) or 500 late transitions are put into the watching part, five times. Late: 1.0 to 2.5 s (`a`,
`b`: 1 to 3 s) over the maximum, normally distributed. Twice: `runglight.injection` takes the maximum of the transition in the whole
clean log; the paper took that of the *actual* time, which only the simulation knows, as it knows what a device waited for.
`plat, 1 s` is the paper's own rule for this experiment: 1 s over the maximum. Alarms are faults and anomalies; any severity counts
notices too. False findings are counted where nothing was inserted, over three plants of each size.""",
    ),
    "budget": (
        "The budget",
        """Learned on 60 %, watched on the rest; recordings by cross-validation, each fifth watched by what the other four taught. Their
operation is presumed nominal, which nobody has confirmed. Counts are too small to prove a rate of 0.1 a day: the bounds are exact (Poisson,
one-sided, 95 % each). *Broken*: the lower bound is above the budget; *kept*: the upper bound is not; else *not refuted*.""",
    ),
    "recordings": (
        "Faults in real recordings",
        """Learned on the first 60 %, injected into the rest, each kind alone, up to 150 (stalls: 5) as far as the recording has room with 10 s
between two; five seeds. `adaptive` has a budget of one false alarm a day, which a few minutes of learning can seldom pay
an alarm from: what it sees, it then tells as a notice.""",
    ),
}


def findings_of(topic: str, results: dict[str, Any]) -> list[str]:
    """What the numbers say of the paper's claims."""
    said: dict[str, Callable[[dict[str, Any]], list[str]]] = {
        "throughput": _of_throughput,
        "clustering": _of_clustering,
        "accuracy": _of_accuracy,
    }
    return said[topic](results) if topic in said else []


def _of_throughput(results: dict[str, Any]) -> list[str]:
    sentences = []
    for size, plant in results.items():
        probes = plant["probes"]
        more = []
        for variant, table in (("linear probing, index", "index"),
                               ("linear probing, devices", "device")):  # fmt: skip
            double = probes["double hashing"]["probes"][table]["probes"]
            linear = probes[variant]["probes"][table]["probes"]
            more.append(f"{100 * (linear / double - 1):+.1f} % in the {table} table")
        slower = [
            probes["linear probing, index"]["rates"][build]
            < probes["double hashing"]["rates"][build]
            for build in ("published", "o3")
        ]
        costs = {2: "costs speed in both builds", 1: "costs speed in one build of the two"}
        sentences.append(
            f"`{size}`: linear probing looks at {' and '.join(more)} (paper: up to +19.3 %), and "
            f"{costs.get(sum(slower), 'costs no speed, against the paper')}."
        )
    return sentences


def _of_clustering(results: dict[str, Any]) -> list[str]:
    sentences = []
    for size, plant in results.items():
        k, of_k = list(plant["k"].items())[-1]
        methods = {
            name: found["merged_while_near"] for name, found in of_k["own"]["methods"].items()
        }
        ours, even = methods["csk_means"], methods["k_means_even"]
        worse = ours["far"] / ours["clusters"] > even["far"] / even["clusters"]
        whole = of_k["all"]["methods"]["csk_means"]["merged_while_near"]
        sentences.append(
            f"`{size}`, k = {k}: {plant['transitions']:,} transitions, {plant['instances']:,} instances. "
            f"After merging, {100 * ours['merged_far'] / ours['merged']:.2f} % of the clusters of the "
            f"{plant['own_transitions']:,} transitions timed by themselves are farther than 0.6 s from the "
            f"optimum (paper: 0 %), of all transitions "
            f"{100 * whole['merged_far'] / whole['merged']:.1f} %: what waits for others has no clusters "
            "to find. "
            + (
                "CSk-means alone is farther off than k-means with evenly spread seeds, against the paper."
                if worse
                else "CSk-means alone is nearer than k-means, as in the paper."
            )
        )
    return sentences


def _of_accuracy(results: dict[str, Any]) -> list[str]:
    sentences = []
    for size, plant in results.items():
        found = plant["by_truth"]["plat, 1 s"]["alarm"]
        inserted = sum(found.get(f"late_{way}", 0) for way in ("own", "hidden"))
        named = sum(found.get(f"late_{way}_found", 0) for way in ("own", "hidden"))
        published = PUBLISHED_LATE.get(size)
        beside = f" (paper: {100 * published:.1f} %)" if published else ""
        sentences.append(
            f"`{size}`: of late transitions timed by themselves PLAT finds "
            f"{100 * named / max(inserted, 1):.1f} %{beside}; how many the paper's plant has whose times "
            "lie together, its text does not say, and that share is what decides it."
        )
    return sentences
