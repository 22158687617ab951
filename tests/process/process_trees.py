"""Random logs: process trees grown from a seed, and the traces they tell.

A tree is an activity's name, None for nothing (silent), or a tuple of an operator and its parts:
`sequence`, `choice`, `parallel`, or `loop` (a body, and what comes before it is done again).
"""

from __future__ import annotations

import random
from typing import Any

Tree = str | tuple[Any, ...] | None

OPERATORS = ("sequence", "choice", "parallel", "loop")
WEIGHTS = (46, 27, 17, 10)


def tree(seed: int, activities: int) -> Tree:
    """A tree of about so many activities; the same seed grows the same tree."""
    chance = random.Random(seed)
    names = iter(f"a{number}" for number in range(activities))
    return _grow(chance, activities, names, "")


def _grow(chance: random.Random, size: int, names: Any, above: str) -> Tree:
    if size == 1:
        leaf: str = next(names)
        return leaf
    operator = chance.choices(OPERATORS, WEIGHTS)[0]
    if operator == above:
        operator = "sequence" if above != "sequence" else "choice"
    parts = min(size, 2 if operator == "loop" else chance.randint(2, 4))
    cuts = sorted(chance.sample(range(1, size), parts - 1))
    sizes = [b - a for a, b in zip([0, *cuts], [*cuts, size], strict=True)]
    grown: list[Tree] = [_grow(chance, part, names, operator) for part in sizes]
    if operator == "choice" and chance.random() < 0.25:
        grown.append(None)
    if operator == "loop" and chance.random() < 0.5:
        # Repeated without anything between.
        grown = [("sequence", *grown), None]
    return (operator, *grown)


def play(tree: Tree, chance: random.Random) -> list[str]:
    """One run through a tree."""
    if tree is None:
        return []
    if isinstance(tree, str):
        return [tree]
    operator, *parts = tree
    if operator == "sequence":
        return [name for part in parts for name in play(part, chance)]
    if operator == "choice":
        return play(chance.choice(parts), chance)
    if operator == "parallel":
        runs = [run for part in parts if (run := play(part, chance))]
        merged = []
        while runs:
            run = chance.choice(runs)
            merged.append(run.pop(0))
            runs = [left for left in runs if left]
        return merged
    body, again = parts
    run = play(body, chance)
    while chance.random() < 0.3 and len(run) < 60:
        run += play(again, chance) + play(body, chance)
    return run


def log(seed: int, traces: int = 100) -> list[list[str]]:
    """A log of a random tree of 4 to 16 activities; no trace is empty."""
    chance = random.Random(seed)
    grown = tree(seed, chance.randint(4, 16))
    runs = (play(grown, chance) for _ in range(traces * 10))
    return [run for run in runs if run][:traces]
