"""A path seen a few times only: how far its time spreads, devices of the same make tell."""

from collections.abc import Sequence

import numpy as np
import pytest

import runglight as rl

SECOND_NS = 1_000_000_000
ROBOTS = [f"Robot{number:02}" for number in range(1, 41)]
UNLIKE = [f"{first}{second}" for first in "ABCDE" for second in "abcdefgh"]
"""As many names that have nothing in common but for digits."""
SIGNALS = ("Measure", "Nok")
CYCLES = 60
REJECTED_EVERY = 12
SPREAD = 0.02
"""A reject is put aside in the robot's own time, give or take so much of it, evenly."""


def own_time_s(robot: int) -> float:
    return 15.0 + 0.3 * robot


def line(robots: Sequence[str], cycles: int, seed: int, late: tuple[int, int, float]) -> rl.Log:
    """Robots that measure each part and put some aside; `late` adds seconds to one reject."""
    draw = np.random.default_rng(seed)
    events: list[tuple[float, int, int]] = []
    for robot in range(len(robots)):
        signal = robot * len(SIGNALS)
        now_s = 0.37 * robot
        for cycle in range(cycles):
            events.append((now_s, signal, 1))
            now_s += 2.0 + 0.05 * draw.random()
            if cycle % REJECTED_EVERY == robot % REJECTED_EVERY:
                events.append((now_s, signal + 1, 1))
                now_s += own_time_s(robot) * (1 + SPREAD * (2 * draw.random() - 1))
                now_s += late[2] if late[:2] == (cycle, robot) else 0.0
                events.append((now_s, signal + 1, 0))
                now_s += 1.0 + 0.05 * draw.random()
            events.append((now_s, signal, 0))
            now_s += 5.0 + 0.05 * draw.random()
    events.sort()
    times, signals, values = zip(*events, strict=True)
    ticks = np.rint(np.array(times) * 100).astype(np.int64)
    names = [f"Group1-{robot}-{signal}" for robot in robots for signal in SIGNALS]
    return rl.Log.from_columns(
        ticks * (SECOND_NS // 100),
        np.array(signals, np.uint32),
        np.array(values, np.int64),
        names,
    )


NEVER = (-1, -1, 0.0)


def late_rejects(robots: Sequence[str], watched: rl.Log) -> list[str]:
    """Devices whose rejects are told to be late."""
    model = rl.learn(line(robots, CYCLES, 1, NEVER), timing="adaptive")
    return [
        finding["device"]
        for finding in model.watch(watched)
        if finding["kind"] == "late" and (finding["from"] or "").endswith("Nok_ON")
    ]


@pytest.mark.parametrize("robot", [0, 7, 23])
def test_sisters_tell_how_far_a_rare_time_spreads(robot: int) -> None:
    def watched(robots: Sequence[str]) -> rl.Log:
        return line(robots, REJECTED_EVERY, 2, (robot % REJECTED_EVERY, robot, 2.5))

    assert late_rejects(ROBOTS, watched(ROBOTS)) == [ROBOTS[robot]]
    # Five rejects alone say next to nothing.
    assert late_rejects(UNLIKE, watched(UNLIKE)) == []


def test_rare_times_that_are_as_ever_are_not_late() -> None:
    assert late_rejects(ROBOTS, line(ROBOTS, 20 * REJECTED_EVERY, 3, NEVER)) == []
