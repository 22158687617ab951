"""Ladder logic as data (IEC 61131-3, 8.2): rungs of contacts, coils and counters, and their scan.

As data, so that a program can be changed by rule: see `mutations`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Contact:
    """-| |- or, negated, -|/|-."""

    variable: str
    negated: bool = False


@dataclass(frozen=True, slots=True)
class Series:
    """Contacts one behind the other: AND. Without parts it conducts."""

    parts: tuple["Network", ...]


@dataclass(frozen=True, slots=True)
class Parallel:
    """Branches one above the other: OR. Without parts it does not conduct."""

    parts: tuple["Network", ...]


Network = Contact | Series | Parallel


@dataclass(frozen=True, slots=True)
class Coil:
    """A rung that ends in -( )- or, negated, -(/)-."""

    network: Network
    variable: str
    negated: bool = False


@dataclass(frozen=True, slots=True)
class CountUp:
    """A rung with a CTU (IEC 61131-3, standard function blocks): `variable` is its output Q."""

    network: Network
    reset: Network
    preset: int
    variable: str


Rung = Coil | CountUp


@dataclass(frozen=True, slots=True)
class Ladder:
    """A program: its rungs from top to bottom, and the variables wired to the terminals."""

    name: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    rungs: tuple[Rung, ...]


@dataclass(slots=True)
class _Counter:
    value: int = 0
    was_on: bool = False


@dataclass(slots=True)
class _Memory:
    variables: dict[str, bool] = field(default_factory=dict)
    counters: dict[int, _Counter] = field(default_factory=dict)


class LadderProgram:
    """A ladder at work: a `Controller` of the scan cycle."""

    def __init__(self, ladder: Ladder) -> None:
        self._ladder = ladder
        self._memory = _Memory()
        self._settled = False

    def scan(self, inputs: Sequence[bool], now_ns: int) -> tuple[bool, ...]:
        """Solves every rung once, top to bottom."""
        del now_ns  # no timers in these ladders
        before = dict(self._memory.variables)
        counted = {number: each.value for number, each in self._memory.counters.items()}
        self._memory.variables.update(zip(self._ladder.inputs, map(bool, inputs), strict=True))
        for number, rung in enumerate(self._ladder.rungs):
            self._solve(number, rung)
        variables = self._memory.variables
        self._settled = before == variables and counted == {
            number: each.value for number, each in self._memory.counters.items()
        }
        return tuple(variables.get(name, False) for name in self._ladder.outputs)

    @property
    def settled(self) -> bool:
        """Whether the last scan left the program's memory as it was."""
        return self._settled

    def next_timer_ns(self) -> None:
        """There are no timers."""
        return

    def _solve(self, number: int, rung: Rung) -> None:
        variables = self._memory.variables
        power = conducts(rung.network, variables)
        if isinstance(rung, Coil):
            variables[rung.variable] = power != rung.negated
            return
        counter = self._memory.counters.setdefault(number, _Counter())
        if conducts(rung.reset, variables):
            counter.value = 0
        elif power and not counter.was_on:
            counter.value += 1
        counter.was_on = power
        variables[rung.variable] = counter.value >= rung.preset


def conducts(network: Network, variables: Mapping[str, bool]) -> bool:
    """Whether power flows from left to right."""
    match network:
        case Contact(variable, negated):
            return variables.get(variable, False) != negated
        case Series(parts):
            return all(conducts(part, variables) for part in parts)
        case Parallel(parts):
            return any(conducts(part, variables) for part in parts)
