"""The cycle of a device, written as text and read as steps.

A step is a signal going on (`CLOSE+`) or off (`CLOSE-`), then one letter for what it comes after:

- `c` the PLC answers the device's last event within its reaction time;
- `l` a sensor is left or reached at once;
- `m` a motion of some seconds ends;
- `p` a program or a timer of some minutes ends;
- `t` a gun cools down;
- `f` somebody, or the material, takes the time it takes;
- `w` the PLC waits for other devices of the cell.

`{A+m B+l}` are two steps in either order, `0.9<A+m A-c|B+m B-c>` one of two paths and the share of
the first, `[A+m A-t]` a rare alarm path. Outputs are written in capitals.
"""

import re
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

Pace = Literal["c", "l", "m", "p", "t", "f", "w"]
Shape = Literal["always", "first", "second", "either order", "alarm"]

_TOKEN = re.compile(r"([\d.]+<)|([|>{}\[\]])|(\w+)([+-])([clmptfw])")


@dataclass(frozen=True, slots=True)
class Step:
    """One event of a cycle. Steps of one `choice` (counted from 0, else -1) belong together."""

    signal: str
    value: int
    pace: Pace
    shape: Shape = "always"
    choice: int = -1


@dataclass(frozen=True, slots=True)
class Cycle:
    """The steps of a device in the order they are written, and how it chooses its path.

    `shares` holds, by choice, how often its second way is taken; None for an alarm path.
    """

    steps: tuple[Step, ...]
    shares: tuple[float | None, ...]

    @property
    def signals(self) -> tuple[str, ...]:
        """Names of the signals in the order of their first steps."""
        return tuple(dict.fromkeys(step.signal for step in self.steps))


@lru_cache(maxsize=512)
def read_cycle(text: str) -> Cycle:
    """Reads the notation above; ValueError where it is none."""
    if rest := _TOKEN.sub("", text).strip():
        raise ValueError(f"no step of a cycle: {rest!r}")
    steps: list[Step] = []
    shares: list[float | None] = []
    shape: Shape = "always"
    for first_share, mark, signal, sign, pace in _TOKEN.findall(text):
        if signal:
            choice = -1 if shape == "always" else len(shares) - 1
            steps.append(Step(signal, int(sign == "+"), pace, shape, choice))
        elif mark in "]}>" and mark:
            shape = "always"
        elif mark == "|":
            shape = "second"
        elif mark == "{":
            shares.append(0.5)
            shape = "either order"
        elif mark == "[":
            shares.append(None)
            shape = "alarm"
        else:
            shares.append(1 - float(first_share[:-1]))
            shape = "first"
    return Cycle(tuple(steps), tuple(shares))
