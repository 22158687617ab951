"""Is what a transition waits for learned? The learned triggers against the simulation's truth."""

from collections import Counter
from typing import Any

import pyarrow as pa

import runglight as rl
from benches.options import Options
from benches.plants import Bodyshop
from benches.tables import Table, share

FEWEST = 20
"""Transitions seen less often teach too little to be held against anyone."""
ANSWERS = {
    "exact": "learned as they are",
    "half": "one of two learned",
    "other": "something else learned",
    "none": "none learned",
}


def measure(options: Options) -> dict[str, Any]:
    """One entry per plant: waits on one and on two causes, by what was learned of them."""
    return {size: _measure_plant(options.bodyshop(size)) for size in options.sizes}


def _measure_plant(plant: Bodyshop) -> dict[str, dict[str, int]]:
    learned = _learned(rl.learn(plant.learn))
    counts = {"1": Counter[str](), "2": Counter[str]()}
    for wait in plant.run.triggers:
        for transition in wait.transitions:
            if transition in learned:
                answer = judged(frozenset(wait.states), learned[transition])
                counts[str(len(wait.states))][answer] += 1
    return {causes: dict(answers) for causes, answers in counts.items()}


def _learned(model: rl.NominalModel) -> dict[tuple[str, str], frozenset[str]]:
    rules = pa.table(model.rules()).to_pylist()
    return {
        (rule["current"], rule["next"]): frozenset((rule["trigger"] or "").split(" & ")) - {""}
        for rule in rules
        if rule["model"] == "device" and rule["count"] >= FEWEST
    }


def judged(true: frozenset[str], learned: frozenset[str]) -> str:
    """What was learned of a wait.

    >>> judged(frozenset({"A", "B"}), frozenset({"B"}))
    'half'
    """
    if not learned:
        return "none"
    if learned == true:
        return "exact"
    return "half" if learned < true else "other"


def tables(results: dict[str, Any]) -> list[Table]:
    """Shares of all waits."""
    rows = []
    for size, plant in results.items():
        for causes, answers in plant.items():
            total = sum(answers.values())
            shares = [share(answers.get(answer, 0), total) for answer in ANSWERS]
            noun = "one event" if causes == "1" else "the later of two"
            rows.append([size, noun, f"{total:,}", *shares])
    return [
        Table(
            "What transitions wait for, learned and true",
            ["plant", "waits for", "transitions", *ANSWERS.values()],
            rows,
            left=2,
        )
    ]
