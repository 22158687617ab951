"""Devices of one make: what one of them never did may be known from the others."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

import runglight as rl

SECOND_NS = 1_000_000_000
GUNS = [f"Gun{number:02}" for number in range(1, 31)]
UNLIKE = [f"{first}{second}" for first in "ABCDE" for second in "abcdef"]
"""As many names that have nothing in common but for digits."""
SIGNALS = ("Clamp", "Weld", "Dress", "Skip")
WELDS = (("Clamp", 1), ("Weld", 1), ("Weld", 0), ("Clamp", 0))
DRESSES = (("Clamp", 1), ("Dress", 1), ("Dress", 0), ("Clamp", 0))
SKIPS = (("Clamp", 1), ("Skip", 1), ("Skip", 0), ("Clamp", 0))
FORGETS = (("Clamp", 1), ("Clamp", 0))
CYCLES = 100

Way = Sequence[tuple[str, int]]


def station(devices: Sequence[str], odd: dict[tuple[int, int], Way], cycles: int) -> rl.Log:
    """Devices that weld one after the other; `odd` says who does what else in which cycle."""
    draw = np.random.default_rng(5)
    times, signals, values = [], [], []
    now_s = 0.0
    for cycle in range(cycles):
        for device in range(len(devices)):
            for signal, value in odd.get((cycle, device), WELDS):
                now_s += 0.4 + 0.02 * draw.random()
                times.append(round(now_s * 100) * SECOND_NS // 100)
                signals.append(device * len(SIGNALS) + SIGNALS.index(signal))
                values.append(value)
            now_s += 0.5
    names = [f"Group1-{device}-{signal}" for device in devices for signal in SIGNALS]
    return rl.Log.from_columns(
        np.array(times, np.int64), np.array(signals, np.uint32), np.array(values, np.int64), names
    )


def judged(devices: Sequence[str], way: Way) -> dict[str, Any]:
    """What is told of the first device, which dressed once, when it goes a way new to it."""
    # Ten dressed once, ten skipped once.
    odd = {(5 + device, device): DRESSES if device < 10 else SKIPS for device in range(20)}
    model = rl.learn(station(devices, odd, CYCLES), timing="adaptive")
    findings = model.watch(station(devices, {(3, 0): way}, 10))
    told = f"Group1-{devices[0]}-Clamp_ON"
    (finding,) = [
        finding
        for finding in findings
        if finding["kind"] == "transition"
        and finding["model"] == "device"
        and finding["from"] == told
        and finding["state"] == "suspected"
    ]
    return finding


def test_what_no_sister_ever_did_is_a_fault() -> None:
    finding = judged(GUNS, FORGETS)
    assert finding["to"] == "Group1-Gun01-Clamp_OFF"
    assert finding["severity"] == "fault"


def test_what_sisters_do_now_and_then_is_a_notice() -> None:
    assert judged(GUNS, SKIPS)["severity"] == "notice"


@pytest.mark.parametrize("way", [FORGETS, SKIPS])
def test_without_sisters_a_device_speaks_for_itself(way: Way) -> None:
    assert judged(UNLIKE, way)["severity"] == "notice"
