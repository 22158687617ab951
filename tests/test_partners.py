"""Stations of one make: what one of them never had to wait for is known from the others."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np
import pyarrow as pa
import pytest

import runglight as rl

SECOND_NS = 1_000_000_000
SCAN_S = 0.01
NUMBERED = [f"St{number}" for number in range(1, 7)]
IN_TENS = [f"St{10 * number}" for number in range(1, 7)]
UNLIKE = ["Load", "Weld", "Glue", "Turn", "Test", "Pack"]
THIRD = 2
"""The station that waits for nobody while the line is learned."""
LONG_S = 6.0
LONG_PARTS = {1: 0, 2: 4, 4: 8}
QUICKER_S = -1.2

Extra = Callable[[int, int], float]
"""Seconds more, by station and part."""


def none(_station: int, _part: int) -> float:
    return 0.0


@dataclass
class Line:
    """A line in which a station hands its part on once its clamp is open and the next one free."""

    names: Sequence[str]
    seed: int
    work: Extra = none
    stop: Extra = none
    start: Extra = none
    rows: list[tuple[float, str, int]] = field(default_factory=list)
    waited: list[int] = field(default_factory=list)
    """Stations that were done before the next one was free."""

    def run(self, parts: int) -> rl.Log:
        """All signals of so many parts."""
        draw = np.random.default_rng(self.seed)
        free_s = [0.0] * (len(self.names) + 1)
        come_s = 0.0
        for part in range(parts):
            come_s = max(come_s + draw.uniform(9.0, 12.0), free_s[0])
            at_s = come_s
            for station, name in enumerate(self.names):
                conveyor, clamp = f"Line1-{name}Conv", f"Line1-{name}Clamp"
                at_s = self.put(at_s + draw.uniform(1.0, 1.02), f"{conveyor}-Present", 1)
                at_s = self.put(at_s + draw.uniform(0.4, 0.42), f"{clamp}-Closed", 1)
                at_s += draw.uniform(1.5, 2.5) + self.work(station, part)
                done_s = self.put(at_s, f"{clamp}-Closed", 0)
                if done_s < free_s[station + 1]:
                    self.waited.append(station)
                due_s = max(done_s, free_s[station + 1]) + self.start(station, part)
                at_s = self.put(due_s + draw.uniform(0.04, 0.06), f"{conveyor}-Run", 1)
                at_s = self.put(at_s + draw.uniform(0.9, 0.92), f"{conveyor}-Present", 0)
                at_s += draw.uniform(0.2, 0.22) + self.stop(station, part)
                at_s = free_s[station] = self.put(at_s, f"{conveyor}-Run", 0)
        return self.log()

    def put(self, time_s: float, signal: str, value: int) -> float:
        """A change, seen at the end of a scan."""
        seen_s = math.ceil(time_s / SCAN_S) * SCAN_S
        self.rows.append((seen_s, signal, value))
        return seen_s

    def log(self) -> rl.Log:
        """All rows in their order."""
        rows = sorted(self.rows, key=lambda row: row[0])
        names = sorted({signal for _, signal, _ in rows})
        return rl.Log.from_columns(
            np.array([round(time_s * 100) * SECOND_NS // 100 for time_s, _, _ in rows], np.int64),
            np.array([names.index(signal) for _, signal, _ in rows], np.uint32),
            np.array([value for _, _, value in rows], np.int64),
            names,
        )


def now_and_then(station: int, part: int) -> float:
    """Second, third and fifth station: those before them must wait. The fourth is quick."""
    if station == THIRD + 1:
        return QUICKER_S
    return LONG_S if part % 12 == LONG_PARTS.get(station) else 0.0


@cache
def learned(names: tuple[str, ...]) -> rl.NominalModel:
    line = Line(names, seed=1, work=now_and_then)
    log = line.run(120)
    assert THIRD not in line.waited
    assert {0, 1, 3} <= set(line.waited)
    return rl.learn(log, timing="adaptive")


def waits_for(names: Sequence[str], station: int) -> set[str]:
    return trigger_of(learned(tuple(names)), names[station])


def trigger_of(model: rl.NominalModel, name: str) -> set[str]:
    """What a station's conveyor waits for."""
    rules = pa.table(model.rules()).to_pylist()
    conveyor = f"Line1-{name}Conv-Run_ON"
    (trigger,) = {rule["trigger"] for rule in rules if rule["next"] == conveyor}
    return set((trigger or "").split(" & "))


def alarms(line: Line) -> list[dict[str, Any]]:
    findings = learned(tuple(line.names)).watch(line.run(30))
    return [finding for finding in findings if finding["severity"] != "notice"]


def of_station(findings: Sequence[dict[str, Any]], name: str) -> set[tuple[str, str]]:
    return {(f["kind"], f["to"]) for f in findings if f["device"] == f"{name}Conv"}


def test_a_station_that_never_waited_waits_for_what_its_sisters_do() -> None:
    for names in (NUMBERED, IN_TENS):
        own, other = names[THIRD], names[THIRD + 1]
        expected = {f"Line1-{own}Clamp-Closed_OFF", f"Line1-{other}Conv-Run_OFF"}
        assert waits_for(names, THIRD) == expected


def test_without_numbers_a_station_waits_for_what_it_showed() -> None:
    assert waits_for(UNLIKE, THIRD) == {f"Line1-{UNLIKE[THIRD]}Clamp-Closed_OFF"}


@pytest.mark.parametrize("times", [1, 2])
def test_without_numbers_two_waits_show_a_partner_and_one_is_chance(times: int) -> None:
    late = {(THIRD + 1, 50): 8.0, (THIRD + 1, 90): 10.0} if times == 2 else {(THIRD + 1, 50): 8.0}
    line = Line(UNLIKE, seed=1, work=lambda *of: late.get(of) or now_and_then(*of))
    model = rl.learn(line.run(120), timing="adaptive")
    assert line.waited.count(THIRD) == times
    partner = {"Line1-TurnConv-Run_OFF"} if times == 2 else set()
    assert trigger_of(model, "Glue") == {"Line1-GlueClamp-Closed_OFF"} | partner


def test_the_last_station_has_no_next_one_to_wait_for() -> None:
    assert waits_for(NUMBERED, 5) == {"Line1-St6Clamp-Closed_OFF"}


def backed_up(station: int, part: int) -> float:
    """The fifth station takes its long time for every part."""
    return LONG_S if station == 4 and part > 5 else now_and_then(station, part)


def test_a_line_that_backs_up_is_no_delay_of_its_stations() -> None:
    line = Line(NUMBERED, seed=2, work=backed_up)
    findings = alarms(line)
    assert THIRD in line.waited
    assert not of_station(findings, "St3")
    # Where nothing is known of the next station, it is.
    late = of_station(alarms(Line(UNLIKE, seed=2, work=line.work)), "Glue")
    assert ("late", "Line1-GlueConv-Run_ON") in late


def test_a_late_partner_is_told_and_who_waits_for_it_is_not() -> None:
    stuck = Line(
        NUMBERED, seed=3, work=now_and_then, stop=lambda *of: 15.0 if of == (3, 20) else 0.0
    )
    findings = alarms(stuck)
    assert THIRD in stuck.waited
    assert ("late", "Line1-St4Conv-Run_OFF") in of_station(findings, "St4")
    assert not of_station(findings, "St3")


def test_a_station_that_is_late_itself_is_still_told() -> None:
    findings = alarms(
        Line(
            NUMBERED, seed=4, work=now_and_then, start=lambda *of: 1.0 if of == (THIRD, 20) else 0.0
        )
    )
    assert ("late", "Line1-St3Conv-Run_ON") in of_station(findings, "St3")
