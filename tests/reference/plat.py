"""PLAT's learning as published (Ghosh 2016), straight-line and in pure Python: the engine's judge.

Written from the paper alone, to be compared with the engine row by row; slow on purpose. Line
numbers are those of the paper's Algorithms 1 to 3. Where the paper leaves room we decided:

Events
 1. A row that repeats its signal's value is a sample: no event.
 2. A signal's first row is an event (the paper's RET_ON > PRT_CHK_ON needs it), unless the log
    begins with an image: if any row at the very first timestamp has the value 0, the rows of that
    timestamp only set values.
 3. Ties in time keep the order of the file.
 4. A signal with any value besides 0 and 1 anywhere in the log, samples included, is a word; its
    states are written `NAME=VALUE`.
 5. A device's starting signal is the first of its signals that has an event.

Algorithm 1
 6. `k` shrinks to N where there are fewer instances than that (the paper would leave unfilled
    positions of -1 in `Pos`); with k = 1 nothing can be split, so it is one cluster.
 7. "less than the user-defined threshold" (line 5) is `span_s`, strictly.
 8. `Gap_Val` starts at -1, so the first k - 1 gaps always get in, even gaps of 0; among equal
    smallest gaps the first is replaced (line 17), and only by a larger gap (line 19).
 9. Sums run left to right over the sorted times, in plain float64. (`sum` would not do: newer
    Pythons compensate it.) The tests for 0 before dividing (lines 8 and 32, Algorithm 2 line 23)
    change nothing and are left out.

Algorithm 2
10. Means that are equal are never passed by line 6, so the loop may end early. The paper then
    keeps stale positions, which may even run backwards. Here the positions not reached become
    N - 1: what is left belongs to the current partition, and the partitions after it are empty.
11. An empty partition's mean is not computed: it keeps the value it had. (Zero, as line 12 read
    alone would leave it, glues 30,30,...,60,60,... into one cluster.)
12. The "very small threshold" of line 27 is 1e-9 s; after 1000 rounds it is enough.

Algorithm 3
13. Empty partitions are dropped before merging; only the last ones can be empty.
14. Among equally near pairs the first is merged (line 20 is strict); centres nearer than
    `merge_s`, strictly, are merged.
15. A cluster stays if its support is strictly greater than `support` (line 38). Probabilities are
    shares of all instances and are not scaled up to 1 after clusters were discarded.
16. If no cluster passes, one cluster of all instances stays, with probability 1.
17. A cluster's minimum is its smallest instance (the paper keeps none).

`minimum_s` and `position` are ours; the rest are the columns of the paper's Table 2.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple, TypedDict

Row = tuple[int, str, int]
"""Time (ns), signal `Group-Device-Signal`, value."""

KMEANS_THRESHOLD_S = 1e-9
KMEANS_ROUNDS = 1000


@dataclass(frozen=True)
class Parameters:
    """The user-defined values of Algorithms 1 to 3; defaults of Ghosh 2016, section 3.2."""

    k: int = 5
    epsilon: float = 20.0
    span_s: float = 3.0
    merge_s: float = 3.0
    support: float = 0.08


class Cluster(NamedTuple):
    average_s: float
    minimum_s: float
    maximum_s: float
    probability: float


class Rule(TypedDict):
    """One time cluster of one transition of one model."""

    model: str
    group: str
    device: str
    current: str
    next: str
    count: int
    transition_probability: float
    cluster: int
    average_s: float
    minimum_s: float
    maximum_s: float
    time_probability: float
    position: int


class Event(NamedTuple):
    time_ns: int
    signal: str
    state: str


def learn(rows: Sequence[Row], parameters: Parameters = Parameters()) -> list[Rule]:
    """The rules of every device and group of a log.

    Devices come first, then groups, each in the order of their first event; within a model the
    transitions stand in the order of their first appearance, and a transition's clusters by time.

    >>> rows = [(0, "G-D-A", 1), (2_000_000_000, "G-D-A", 0), (3_000_000_000, "G-D-A", 1),
    ...         (6_000_000_000, "G-D-A", 0)]
    >>> for rule in learn(rows):
    ...     print(rule["model"], rule["current"], rule["next"], rule["count"], rule["average_s"])
    device G-D-A_ON G-D-A_OFF 2 2.5
    device G-D-A_OFF G-D-A_ON 1 1.0
    group G-D-A_ON G-D-A_OFF 2 2.5
    group G-D-A_OFF G-D-A_ON 1 1.0
    """
    device_chains: dict[tuple[str, str], list[Event]] = {}
    group_chains: dict[str, list[Event]] = {}
    starting: dict[tuple[str, str], str] = {}
    for event in events(rows):
        group, device, _ = split_name(event.signal)
        device_chains.setdefault((group, device), []).append(event)
        if starting.setdefault((group, device), event.signal) == event.signal:
            group_chains.setdefault(group, []).append(event)
    rules: list[Rule] = []
    for (group, device), chain in device_chains.items():
        rules += chain_rules("device", group, device, chain, parameters)
    for group, chain in group_chains.items():
        rules += chain_rules("group", group, "", chain, parameters)
    return rules


def split_name(name: str) -> tuple[str, str, str]:
    """Group, device and signal of a full name; the signal may contain the separator.

    >>> split_name("Group1-RBT1-HOME_POS")
    ('Group1', 'RBT1', 'HOME_POS')
    """
    group, device, signal = name.split("-", 2)
    return group, device, signal


def events(rows: Sequence[Row]) -> list[Event]:
    """The changes in a log, in file order (decisions 1 to 4).

    >>> [event.state for event in events([(0, "G-D-A", 1), (0, "G-D-B", 0), (1, "G-D-B", 1)])]
    ['G-D-B_ON']
    >>> [event.state for event in events([(0, "G-D-A", 1), (1, "G-D-B", 0), (2, "G-D-A", 1)])]
    ['G-D-A_ON', 'G-D-B_OFF']
    """
    if not rows:
        return []
    words = {signal for _, signal, value in rows if value not in (0, 1)}
    first_ns = rows[0][0]
    image = any(time_ns == first_ns and value == 0 for time_ns, _, value in rows)
    values: dict[str, int] = {}
    found: list[Event] = []
    for time_ns, signal, value in rows:
        if values.get(signal) == value:
            continue
        values[signal] = value
        if image and time_ns == first_ns:
            continue
        state = f"={value}" if signal in words else ("_ON" if value else "_OFF")
        found.append(Event(time_ns, signal, signal + state))
    return found


def chain_rules(
    model: str, group: str, device: str, chain: Sequence[Event], parameters: Parameters
) -> list[Rule]:
    """The rules of one model from the chain of its events."""
    times_s: dict[tuple[str, str], list[float]] = {}
    leaving: dict[str, int] = {}
    for before, after in pairwise(chain):
        elapsed_s = (after.time_ns - before.time_ns) / 1e9
        times_s.setdefault((before.state, after.state), []).append(elapsed_s)
        leaving[before.state] = leaving.get(before.state, 0) + 1
    rules: list[Rule] = []
    for position, ((current, following), times) in enumerate(times_s.items()):
        for number, cluster in enumerate(time_clusters(times, parameters)):
            rules.append(
                {
                    "model": model,
                    "group": group,
                    "device": device,
                    "current": current,
                    "next": following,
                    "count": len(times),
                    "transition_probability": len(times) / leaving[current],
                    "cluster": number,
                    "average_s": cluster.average_s,
                    "minimum_s": cluster.minimum_s,
                    "maximum_s": cluster.maximum_s,
                    "time_probability": cluster.probability,
                    "position": position,
                }
            )
    return rules


def time_clusters(times_s: Iterable[float], parameters: Parameters) -> list[Cluster]:
    """Algorithm 1: the clusters of one transition's times, by time.

    >>> time_clusters([1.0, 2.0], Parameters())
    [Cluster(average_s=1.5, minimum_s=1.0, maximum_s=2.0, probability=1.0)]
    >>> for cluster in time_clusters([30.0, 60.0, 30.0, 61.0], Parameters()): print(cluster)
    Cluster(average_s=30.0, minimum_s=30.0, maximum_s=30.0, probability=0.5)
    Cluster(average_s=60.5, minimum_s=60.0, maximum_s=61.0, probability=0.5)
    """
    time_array = sorted(times_s)  # line 4
    n = len(time_array)
    k = min(parameters.k, n)
    if time_array[n - 1] - time_array[0] < parameters.span_s or k < 2:  # line 5
        return [one_cluster(time_array)]
    positions = seed_positions(time_array, k, parameters.epsilon)
    averages = [mean(time_array[low : high + 1]) for low, high in partitions(positions, n)]
    k_means(time_array, positions, averages)
    return merged(time_array, positions, averages, parameters)


def one_cluster(time_array: Sequence[float]) -> Cluster:
    """All instances in one cluster (lines 6 to 10)."""
    return Cluster(mean(time_array), time_array[0], time_array[-1], 1.0)


def mean(times_s: Sequence[float]) -> float:
    """Left to right in plain float64 (decision 9)."""
    total = 0.0
    for time_s in times_s:
        total += time_s
    return total / len(times_s)


def partitions(positions: Sequence[int], n: int) -> list[tuple[int, int]]:
    """First and last index of each partition (lines 22 to 29); the last < the first if empty.

    >>> partitions([1, 2], 5)
    [(0, 1), (2, 2), (3, 4)]
    """
    firsts = [0, *(position + 1 for position in positions)]
    return list(zip(firsts, [*positions, n - 1], strict=True))


def seed_positions(time_array: Sequence[float], k: int, epsilon: float) -> list[int]:
    """The ends of the first k - 1 partitions, at the largest relative gaps (lines 12 to 21).

    >>> seed_positions([1.0, 2.0, 9.0, 10.0, 40.0], 3, 20.0)
    [1, 3]
    """
    gap_val = [-1.0] * (k - 1)
    pos = [-1] * (k - 1)
    for i in range(len(time_array) - 1):
        gap = (time_array[i + 1] - time_array[i]) / (time_array[i] + epsilon)
        smallest, smallest_index = gap_val[0], 0
        for j in range(1, k - 1):
            if gap_val[j] < smallest:
                smallest, smallest_index = gap_val[j], j
        if gap > smallest:
            gap_val[smallest_index], pos[smallest_index] = gap, i
    return sorted(pos)


def k_means(time_array: Sequence[float], pos: list[int], clus_avg: list[float]) -> None:
    """Algorithm 2; changes `pos` and `clus_avg` in place."""
    n, k = len(time_array), len(clus_avg)
    for _ in range(KMEANS_ROUNDS):
        temp = 0
        for i in range(1, n):
            dist1 = abs(time_array[i] - clus_avg[temp])
            dist2 = abs(time_array[i] - clus_avg[temp + 1])
            if dist1 > dist2:
                pos[temp] = i - 1
                temp += 1
            if temp == k - 1:
                break
        for unreached in range(temp, k - 1):  # decision 10
            pos[unreached] = n - 1
        old_clus_avg = list(clus_avg)
        for i, (low, high) in enumerate(partitions(pos, n)):
            if low <= high:  # decision 11
                clus_avg[i] = mean(time_array[low : high + 1])
        if all(
            abs(new - old) <= KMEANS_THRESHOLD_S
            for new, old in zip(clus_avg, old_clus_avg, strict=True)
        ):
            return


def merged(
    time_array: Sequence[float],
    pos: Sequence[int],
    clus_avg: Sequence[float],
    parameters: Parameters,
) -> list[Cluster]:
    """Algorithm 3: merges near clusters, and drops those of low support."""
    n = len(time_array)
    averages: list[float] = []
    totals: list[int] = []
    minima: list[float] = []
    maxima: list[float] = []
    for average, (low, high) in zip(clus_avg, partitions(pos, n), strict=True):
        if low <= high:  # decision 13
            averages.append(average)
            totals.append(high - low + 1)
            minima.append(time_array[low])
            maxima.append(time_array[high])
    while len(averages) > 1:
        short_dist, left = averages[1] - averages[0], 0
        for i in range(1, len(averages) - 1):
            if averages[i + 1] - averages[i] < short_dist:
                short_dist, left = averages[i + 1] - averages[i], i
        if not short_dist < parameters.merge_s:
            break
        right = left + 1
        tmp1 = averages[left] * totals[left]
        tmp2 = averages[right] * totals[right]
        tmp3 = totals[left] + totals[right]
        averages[left] = (tmp1 + tmp2) / tmp3
        totals[left] = tmp3
        maxima[left] = maxima[right]
        del averages[right], totals[right], minima[right], maxima[right]
    kept = [
        Cluster(average, minimum, maximum, total / n)
        for average, total, minimum, maximum in zip(averages, totals, minima, maxima, strict=True)
        if total / n > parameters.support
    ]
    return kept or [one_cluster(time_array)]  # decision 16
