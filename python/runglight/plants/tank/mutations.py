"""Small errors put into a ladder program by rule, as a tired programmer would make them."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from runglight.plants.tank.ladder import (
    Coil,
    Contact,
    CountUp,
    Ladder,
    Network,
    Parallel,
    Rung,
    Series,
)


@dataclass(frozen=True, slots=True)
class Mutation:
    """A program with one error in it, and the error in words."""

    sentence: str
    ladder: Ladder


def mutations(ladder: Ladder) -> list[Mutation]:
    """Every program that is one error away: contacts negated, swapped or left out, branches put in
    series and series in parallel, coils negated, counters set otherwise, rungs left out.
    """  # noqa: D205
    variables = (*ladder.inputs, *(rung.variable for rung in ladder.rungs))
    found: list[Mutation] = []
    for number, rung in enumerate(ladder.rungs):
        place = f"rung {number + 1} ({rung.variable})"
        for words, mutant in _of_rung(rung, variables):
            rungs = (*ladder.rungs[:number], mutant, *ladder.rungs[number + 1 :])
            found.append(Mutation(f"{place}: {words}", replace(ladder, rungs=rungs)))
        rest = (*ladder.rungs[:number], *ladder.rungs[number + 1 :])
        found.append(Mutation(f"{place} left out", replace(ladder, rungs=rest)))
    return found


def chosen(among: list[Mutation], count: int, seed: int) -> list[Mutation]:
    """Some of them, the same for the same seed."""
    order = np.random.default_rng(seed).permutation(len(among))
    return [among[int(number)] for number in order[:count]]


def _of_rung(rung: Rung, variables: tuple[str, ...]) -> Iterator[tuple[str, Rung]]:
    for words, network in _of_network(rung.network, variables):
        yield words, replace(rung, network=network)
    if isinstance(rung, Coil):
        yield "coil negated", replace(rung, negated=not rung.negated)
    if isinstance(rung, CountUp):
        for preset in (rung.preset - 1, rung.preset + 1):
            yield f"preset {preset}", replace(rung, preset=preset)
        for words, network in _of_network(rung.reset, variables):
            yield f"reset: {words}", replace(rung, reset=network)


def _of_network(network: Network, variables: tuple[str, ...]) -> Iterator[tuple[str, Network]]:
    if isinstance(network, Contact):
        yield f"{network.variable} negated", replace(network, negated=not network.negated)
        for other in variables:
            if other != network.variable:
                yield f"{other} instead of {network.variable}", replace(network, variable=other)
        return
    turned = Parallel(network.parts) if isinstance(network, Series) else Series(network.parts)
    yield f"{_said(network)} made {_said(turned)}", turned
    for number, part in enumerate(network.parts):
        before, after = network.parts[:number], network.parts[number + 1 :]
        yield (
            f"{_named(part)} left out of {_said(network)}",
            replace(network, parts=(*before, *after)),
        )
        for words, mutant in _of_network(part, variables):
            yield words, replace(network, parts=(*before, mutant, *after))


def _said(network: Series | Parallel) -> str:
    return "series" if isinstance(network, Series) else "parallel"


def _named(network: Network) -> str:
    return network.variable if isinstance(network, Contact) else _said(network)
