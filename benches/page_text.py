"""The sentences of the page; what they say of a number, they read from it."""

from collections.abc import Callable
from typing import Any

from benches import budget as budgets
from benches.accuracy import PUBLISHED_LATE

HEAD = """<!-- Written by benches/page.py from benchmarks.json; run `make bench`. -->

# Benchmarks

Measured by `make bench`, seeded, on simulated plants and real recordings. Speeds are events per
second of processor time, the best of several repetitions; ratios are of one run, in which all
contenders take turns. The numbers behind the tables are in `benchmarks.json`.

"""

NOTES: dict[str, tuple[str, str]] = {
    "throughput": (
        "Speed and memory",
        """\
The [body shop](bodyshop.md) in its three sizes. *Columns* are numpy arrays made a log beforehand,
*Arrow* are tables of 262,144 rows with a dictionary of names. The C++ is `benches/plat_baseline`:
the paper's own structures, built as published (no flags) and with -O3, double hashing, watching
the same log in the same order; of all, what is timed is watching, not what a monitor costs to make.
The plain loop does one load and store in a table of 64 bytes a signal per event, and nothing else.
Memory is by how much the process grows, code aside, when a saved model is loaded and a monitor
made. `plat` takes the allowances of Table 4.""",
    ),
    "clustering": (
        "Clusterings (Figures 17, 22 and 23)",
        """\
Transitions of the learning part that Algorithm 1 clusters: their times span at least 3 s.
CSk-means and merging (HAC, 3 s) follow the paper; k-means takes its seeds from the sorted times,
evenly spread or drawn; the optimum is found by dynamic programming, for the same number of
clusters. A cluster is far off where its centre lies more than 0.6 s from the optimum's. *Merged to
the true number* goes on merging until at most as many clusters are left as the plant has part
types. Times are of the benches' own C, not of the engine.""",
    ),
    "accuracy": (
        "Detection (Tables 5 and 6)",
        """\
150 faults of order and 1,500 (`main`) or 500 late transitions are put into the watching part, five
times. Late: 1.0 to 2.5 s (`a`, `b`: 1 to 3 s) over the maximum, normally distributed. Twice:
`runglight.injection` takes the maximum of the transition in the whole clean log; the paper took
that of the *actual* time, which only the simulation knows, as it knows what a device waited for. A
time made so late that it equals another actual time of its transition is *hidden*: no clock can
tell it. `plat, 1 s` is the paper's own rule for this experiment: 1 s over the maximum. Alarms are
faults and anomalies that name the device; *in an incident with one* also counts notices that name
it and follow an alarm elsewhere; *by anything* counts all notices. *People's work* is what people
or material take, up to several times the least: a second or two over the longest of ninety such
times is work as usual to whoever has seen no more than those. *Who knows the law* of each spends
all of ten false alarms per million events on them. False findings are counted where nothing was
inserted, over three plants of each size. `adaptive` has the default budget of one false alarm a
day; *3 a day* shows what three buy.""",
    ),
    "triggers": (
        "What transitions wait for",
        """\
The body shop's devices wait for events of other devices; the simulation knows which. Here are the
transitions of such waits that the learning part shows at least 20 times. Where another
trigger than the true one always came at the same time, no log can tell them apart.""",
    ),
    "delays": (
        "Where devices wait for one another",
        """\
Plants of another make (`benches/waiting`): three lines whose stations block one another and whose
robots share zones, three rotary tables that wait for the slowest of six stations, three plating
lines whose baths share a hoist; 49,200 events each, five seeds. Names carry neither classes nor
addresses, cause and effect often bear the same time, and one hour or two of operation are all
there is to learn from: 60 %. About one motion in eighty of the rest is delayed by 1 to 2.5 s, and
holds up whoever waits for it. A delay is found where a finding names its device at its time;
*other alarms* are those of devices that only waited, and of nothing at all. The demands are those
of the body shop: 99 % of the delays, ten false alarms per million nominal events, of which one
plant's five nominal runs have 98,400: one alarm is ten per million.""",
    ),
    "budget": (
        "The budget",
        """\
Learned on 60 %, watched on the rest; recordings by cross-validation, each fifth watched by what
the other four taught. Their operation is presumed nominal, which nobody has confirmed. Minutes of
recording cannot prove a rate of 0.1 a day: the bounds are exact (Poisson, one-sided, 95 % each).
*Broken*: the lower bound is above the budget; *kept*: the upper bound is not; else *not
refuted*.""",
    ),
    "recordings": (
        "Faults in real recordings",
        """\
Learned on the first 60 %, injected into the rest, each kind alone, up to 150 (stalls: 5) as far as
the recording has room with 10 s between two; five seeds. `adaptive` has a budget of one false
alarm a day, which a few minutes of learning can seldom pay an alarm from: what it sees, it then
tells as a notice. `plat` knows no early limit.""",
    ),
}  # fmt: skip


def findings_of(topic: str, results: dict[str, Any]) -> list[str]:
    """What the numbers say of the paper's claims."""
    said: dict[str, Callable[[dict[str, Any]], list[str]]] = {
        "throughput": _of_throughput,
        "clustering": _of_clustering,
        "accuracy": _of_accuracy,
        "budget": _of_budget,
    }
    return said[topic](results) if topic in said else []


def _of_throughput(results: dict[str, Any]) -> list[str]:
    costs = {
        2: "costs speed in both builds",
        1: "costs speed in one build of the two",
        0: "costs no speed, against the paper",
    }
    sentences = []
    for size, plant in results.items():
        double = plant["probes"]["double hashing"]
        linear = {
            "index": plant["probes"]["linear probing, index"],
            "device": plant["probes"]["linear probing, devices"],
        }
        ratios = {
            table: _probes(each, table) / _probes(double, table) for table, each in linear.items()
        }
        more = " and ".join(
            f"{100 * (ratio - 1):+.1f} % in the {table} table" for table, ratio in ratios.items()
        )
        rates = linear["index"]["rates"], double["rates"]
        slower = sum(rates[0][build] < rates[1][build] for build in ("published", "o3"))
        sentences.append(
            f"`{size}`: linear probing takes {more} of double hashing's probes (paper: up to "
            f"+19.3 %); it {costs[slower]}."
        )
    return sentences


def _probes(found: dict[str, Any], table: str) -> int:
    probes: int = found["probes"][table]["probes"]
    return probes


def _of_clustering(results: dict[str, Any]) -> list[str]:
    sentences = []
    for size, plant in results.items():
        k, of_k = list(plant["k"].items())[-1]
        own, everything = (
            {name: found["merged_while_near"] for name, found in of_k[which]["methods"].items()}
            for which in ("own", "all")
        )
        csk_means, even = _far(own["csk_means"]), _far(own["k_means_even"])
        sentences.append(
            f"`{size}`, k = {k}: {plant['transitions']:,} transitions with {plant['instances']:,} "
            f"instances, {plant['own_transitions']:,} of them timed by themselves. Of those, "
            f"{_far(own['csk_means'], 'merged'):.2f} % of the clusters are farther than 0.6 s from "
            "the optimum after CSk-means and merging (paper: 0 %); of all, "
            f"{_far(everything['csk_means'], 'merged'):.1f} %: what waits for others has no "
            f"clusters to find. CSk-means alone leaves {csk_means:.1f} % far off, k-means with "
            f"evenly spread seeds {even:.1f} %: {'as' if csk_means < even else 'not as'} in the "
            "paper, where CSk-means is nearer. The exact method takes "
            f"{of_k['all']['exact_s'] / of_k['all']['published_s']:.1f} times as long as CSk-means "
            f"and merging: {1e3 * of_k['all']['exact_s']:.0f} ms for the whole plant, for every "
            f"number of clusters up to {k}."
        )
    return sentences


def _far(found: dict[str, Any], what: str = "") -> float:
    """Percentage of clusters that are far off."""
    part, whole = ("merged_far", "merged") if what else ("far", "clusters")
    return float(100 * found[part] / max(found[whole], 1))


def _of_budget(results: dict[str, Any]) -> list[str]:
    sentences = []
    for budget in budgets.BUDGETS:
        answers: dict[str, list[str]] = {}
        for source, found in results["rates"].items():
            answer = budgets.judged(found[str(budget)], budget).strip("*")
            answers.setdefault(answer, []).append(source)
        counted = ", ".join(f"{len(answers.get(each, []))} {each}" for each in budgets.ANSWERS)
        broken = answers.get("broken", [])
        sentences.append(
            f"{budget:g} a day: {counted}" + (f" ({', '.join(broken)})." if broken else ".")
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
            f"{100 * named / max(inserted, 1):.1f} %{beside}. It misses those whose actual times "
            "were merged; how many lie so near one another in the paper's plants is not said."
        )
    return sentences
