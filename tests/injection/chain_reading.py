"""Device chains of a log read the plain way, to check the injector by."""

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

from runglight.log.changelog import Log

RANK = {"input": 0, "memory": 1, "output": 2}


@dataclass(frozen=True)
class Event:
    time: int
    device: str
    state: str


def events(log: Log) -> Iterator[Event]:
    """Every change in the order of time, and of the signals where times are equal."""
    time, index, value = (column.tolist() for column in log.columns())
    rows = sorted(zip(time, index, range(len(time)), value, strict=True))
    values: dict[int, int] = {}
    for moment, signal, _, now in rows:
        if values.get(signal) != now:
            values[signal] = now
            name = log.signals[signal]
            yield Event(moment, name.rsplit("-", 1)[0], f"{name}_{'ON' if now else 'OFF'}")


def chains(log: Log) -> dict[str, list[Event]]:
    """Events by device, `Group1-PrtLDR`."""
    found: dict[str, list[Event]] = defaultdict(list)
    for event in events(log):
        found[event.device].append(event)
    return found


def transitions(log: Log) -> dict[tuple[str, str], list[tuple[int, int]]]:
    """When each transition ended, and how long it took, in nanoseconds."""
    found: dict[tuple[str, str], list[tuple[int, int]]] = defaultdict(list)
    for chain in chains(log).values():
        for before, after in pairwise(chain):
            found[before.state, after.state].append((after.time, after.time - before.time))
    return found


def true_times(log: Log) -> dict[tuple[str, str], tuple[int, int]]:
    """Least and most time of each transition, but for what the log begins with."""
    start = int(log.columns()[0][0])
    return {
        states: (min(times), max(times))
        for states, passes in transitions(log).items()
        if (times := [took for at, took in passes if at > start])
    }
