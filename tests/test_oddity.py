"""What a healthy machine may still hold back: how odd its parts have been says where it is odd."""

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
import pytest

import runglight as rl

SECOND_NS = 1_000_000_000
TICK_S = 0.01

Event = tuple[float, str, int]
"""Seconds, signal, value."""


def log_of(events: Iterable[Event]) -> rl.Log:
    ordered = sorted(events, key=lambda event: event[0])
    names = sorted({name for _, name, _ in ordered})
    number = {name: index for index, name in enumerate(names)}
    ticks = np.rint(np.array([time_s for time_s, _, _ in ordered]) / TICK_S).astype(np.int64)
    return rl.Log.from_columns(
        ticks * round(TICK_S * SECOND_NS),
        np.array([number[name] for _, name, _ in ordered], np.uint32),
        np.array([value for _, _, value in ordered], np.int64),
        names,
    )


def first_told(findings: Iterable[dict[str, Any]]) -> list[dict[str, Any]]:
    """Each finding as it was told first."""
    first: dict[str, dict[str, Any]] = {}
    for finding in findings:
        first.setdefault(finding["id"], finding)
    return list(first.values())


def alarms(findings: Iterable[dict[str, Any]]) -> list[dict[str, Any]]:
    return [finding for finding in first_told(findings) if finding["severity"] != "notice"]


def baths(seed: int, from_s: float, to_s: float) -> Iterator[Event]:
    """Six baths of one group that fill and drain when they like: any may follow any other."""
    draw = np.random.default_rng(seed)
    for bath in range(1, 7):
        now_s = from_s + 40 * draw.random()
        while now_s < to_s:
            yield now_s, f"Plating-Bath{bath}-Level", 1
            yield now_s + 20 + 0.1 * draw.random(), f"Plating-Bath{bath}-Level", 0
            now_s += 30 + bath + 60 * draw.random()


@pytest.mark.parametrize("seed", range(4))
def test_what_is_new_among_devices_that_go_their_own_ways_is_no_alarm(seed: int) -> None:
    model = rl.learn(log_of(baths(seed, 0.0, 3600.0)))
    findings = first_told(model.watch(log_of(baths(seed + 100, 3600.0, 10_800.0))))
    new = [finding for finding in findings if finding["kind"] == "transition"]
    assert new, "one hour shows all ways of six baths: the test is of no use"
    assert {finding["model"] for finding in new} == {"group"}
    assert alarms(new) == []


def lamps(odd: dict[tuple[int, int], float], cycles: int, seed: int) -> Iterator[Event]:
    """Ten lamps, each lit for 2 s; `odd` adds seconds to a lamp in a cycle."""
    draw = np.random.default_rng(seed)
    for lamp in range(10):
        now_s = 0.71 * lamp
        for cycle in range(cycles):
            yield now_s, f"Panel-Lamp{lamp}-On", 1
            now_s += 2.0 + 0.02 * draw.random() + odd.get((cycle, lamp), 0.0)
            yield now_s, f"Panel-Lamp{lamp}-On", 0
            now_s += 8.0 + 0.02 * draw.random()


LIT_LONGER = {(5, 3): 1.5}


def severity_of_late(odd_when_learned: dict[tuple[int, int], float]) -> set[str]:
    model = rl.learn(log_of(lamps(odd_when_learned, 120, 1)))
    findings = first_told(model.watch(log_of(lamps(LIT_LONGER, 12, 2))))
    return {finding["severity"] for finding in findings if finding["kind"] == "late"}


def test_an_odd_time_of_a_start_does_not_excuse_later_ones() -> None:
    assert severity_of_late({}) == {"anomaly"}
    assert severity_of_late({(0, 3): 4.0}) == {"anomaly"}


def test_an_odd_time_in_operation_is_not_taken_for_one_of_the_start() -> None:
    assert severity_of_late({(60, 3): 4.0}) == {"notice"}


def stations(odd: bool, cycles: int, late: tuple[int, int], seed: int) -> Iterator[Event]:
    """Eight stations with a gate, that people sometimes hold, and a drill, that nobody holds."""
    draw = np.random.default_rng(seed)
    for station in range(8):
        now_s = 0.93 * station
        for cycle in range(cycles):
            yield now_s, f"Line-Gate{station}-Open", 1
            held = odd and cycle > 0 and draw.random() < 0.05
            now_s += 1.5 + 0.02 * draw.random() + (2 + 20 * draw.random() if held else 0.0)
            yield now_s, f"Line-Gate{station}-Open", 0
            now_s += 0.3
            yield now_s, f"Line-Drill{station}-Down", 1
            now_s += 3.0 + 0.02 * draw.random() + (1.5 if (cycle, station) == late else 0.0)
            yield now_s, f"Line-Drill{station}-Down", 0
            now_s += 5.0 + 0.02 * draw.random()


def test_gates_that_people_hold_do_not_make_drills_odd() -> None:
    model = rl.learn(log_of(stations(odd=True, cycles=50, late=(-1, -1), seed=1)))
    watched = log_of(stations(odd=False, cycles=12, late=(5, 4), seed=2))
    late = [finding for finding in first_told(model.watch(watched)) if finding["kind"] == "late"]
    assert (late[0]["device"], late[0]["severity"]) == ("Drill4", "anomaly")
