"""Where the tokens are after every event: a run walked through a net, for people to look at.

The engine's replay counts; this one remembers the way. A net may allow an event in several ways,
and only later events tell which one it was: all of them are followed, up to a number, and the one
with the fewest silent firings is shown. Where none is left, the run departs from the net: the
tokens that are missing are added, and it goes on from there.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING

import msgspec

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from runglight.process.petri_net import PetriNet, Transition

Marking = tuple[int, ...]
WAYS_KEPT = 1_000
WAYS_FORCED = 16
"""Where no way is left, so many are looked at for the one that misses the fewest tokens."""
MARKINGS_LOOKED_AT = 2_000
"""Of one search through silent transitions."""
REMEMBERED = 50_000
"""Moves that are not worked out again: runs of a machine are alike."""


class Step(msgspec.Struct, frozen=True, omit_defaults=True):
    """What one event did. Places and transitions are numbers."""

    fired: list[int]
    """Transitions in their order, the silent ones first; none where the net has no such event."""
    marking: dict[int, int]
    """Tokens by place, afterwards; places without any are left out."""
    missing: list[int] = []
    """Places to which a token had to be added: the net does not allow the event here."""
    remaining: list[int] = []
    """At the end of a run: places that hold a token too many."""
    known: bool = True
    """False where the net has no such activity."""

    @property
    def departs(self) -> bool:
        """Whether the net does not allow it."""
        return bool(self.missing or self.remaining or not self.known)


@dataclass(frozen=True, slots=True)
class _Way:
    """One way in which the run may have come here."""

    marking: Marking
    before: _Way | None = None
    fired: tuple[int, ...] = ()
    missing: tuple[int, ...] = ()
    remaining: tuple[int, ...] = ()
    known: bool = True

    def step(self) -> Step:
        return Step(
            fired=list(self.fired),
            marking={place: count for place, count in enumerate(self.marking) if count},
            missing=list(self.missing),
            remaining=list(self.remaining),
            known=self.known,
        )


class TokenWalk:
    """Walks runs through one net. Begins at the initial marking."""

    def __init__(self, net: PetriNet) -> None:
        self._transitions = net.transitions
        self._initial: Marking = tuple(net.initial)
        self._last: Marking = tuple(net.last)
        self._by_label: dict[str, list[int]] = {}
        for number, transition in enumerate(self._transitions):
            if transition.label is not None:
                self._by_label.setdefault(transition.label, []).append(number)
        silent = [n for n, each in enumerate(self._transitions) if each.label is None]
        self._silent = frozenset(silent)
        self._helpful: dict[str, frozenset[int]] = {}
        self._takes: list[list[int]] = [[] for _ in net.places]
        """Silent transitions by the first place that they take a token from."""
        for number in silent:
            for place in self._transitions[number].inputs[:1]:
                self._takes[place].append(number)
        self._moves: dict[tuple[Marking, str], list[tuple[Marking, tuple[int, ...]]]] = {}
        self._ends: dict[Marking, tuple[Marking, tuple[int, ...]]] = {}
        self._ways: list[_Way] = [_Way(self._initial)]

    def restart(self) -> None:
        """Back to the initial marking: a run opens."""
        self._ways = [_Way(self._initial)]

    def anywhere(self) -> bool:
        """Takes up the net wherever it may be; events tell where. False where that is too wide."""
        found = {self._initial}
        waiting = deque(found)
        while waiting:
            marking = waiting.popleft()
            for transition in self._transitions:
                after = _fired(marking, transition)
                if after is not None and after not in found:
                    if len(found) >= MARKINGS_LOOKED_AT:
                        return False
                    found.add(after)
                    waiting.append(after)
        self._ways = [_Way(marking) for marking in sorted(found)]
        return True

    @property
    def sure(self) -> bool:
        """Whether there is one place only where the run can be."""
        return len(self._ways) == 1

    @property
    def marking(self) -> dict[int, int]:
        """Tokens by place, as shown."""
        return self._ways[0].step().marking

    def knows(self, label: str) -> bool:
        """Whether the net has such an activity."""
        return label in self._by_label

    def opens(self, label: str) -> bool:
        """Whether a run can begin with this activity."""
        if label not in self._by_label:
            return False
        return bool(self._followed(self._initial, label))

    def allows(self, label: str) -> bool:
        """Whether this activity can come now."""
        if label not in self._by_label:
            return False
        return any(self._followed(way.marking, label) for way in self._ways)

    def step(self, label: str) -> Step:
        """Follows one event."""
        if label not in self._by_label:
            self._ways = [_Way(way.marking, way, known=False) for way in self._ways[:WAYS_KEPT]]
            return self._ways[0].step()
        after: dict[Marking, _Way] = {}
        for way in self._ways:
            for marking, fired in self._followed(way.marking, label):
                known = after.get(marking)
                if known is None or len(fired) < len(known.fired):
                    after[marking] = _Way(marking, way, fired)
        found = sorted(after.values(), key=lambda way: len(way.fired))
        self._ways = found[:WAYS_KEPT] or [self._forced(label)]
        return self._ways[0].step()

    def end(self) -> Step:
        """Ends the run: silent transitions to the final marking, and what is left over then."""
        ends = [self._ended(way) for way in self._ways]
        best = min(ends, key=lambda way: (len(way.missing) + len(way.remaining), len(way.fired)))
        self._ways = [best]
        return best.step()

    def forget(self) -> None:
        """Lets go of how the run came here, where nobody will ask."""
        self._ways = [_Way(way.marking) for way in self._ways]

    def steps(self) -> list[Step]:
        """Every step since the run opened, by the way that turned out to be the right one."""
        found: list[Step] = []
        way: _Way | None = self._ways[0]
        while way is not None and way.before is not None:
            found.append(way.step())
            way = way.before
        return found[::-1]

    def walk(self, run: Iterable[str]) -> list[Step]:
        """A whole run: a step for every event, and one for its end."""
        self.restart()
        for label in run:
            self.step(label)
        self.end()
        return self.steps()

    def enabled(self) -> list[int]:
        """Visible transitions that can be next."""
        found: dict[int, None] = {}
        for marking, _ in self._through_silence(self._ways[0].marking, self._silent):
            for number, transition in enumerate(self._transitions):
                if transition.label is not None and _enabled(marking, transition):
                    found[number] = None
        return sorted(found)

    def _followed(self, marking: Marking, label: str) -> list[tuple[Marking, tuple[int, ...]]]:
        """Where an event can lead without adding a token, and what fires on the shortest way."""
        known = self._moves.get((marking, label))
        if known is not None:
            return known
        found: dict[Marking, tuple[int, ...]] = {}
        for here, silent in self._through_silence(marking, self._help(label)):
            for number in self._by_label[label]:
                after = _fired(here, self._transitions[number])
                if after is not None:
                    found.setdefault(after, (*silent, number))
        if len(self._moves) >= REMEMBERED:
            self._moves.clear()
        self._moves[marking, label] = list(found.items())
        return self._moves[marking, label]

    def _forced(self, label: str) -> _Way:
        """The way that takes the fewest tokens from nowhere."""
        best: tuple[int, int, _Way] | None = None
        for way in self._ways[:WAYS_FORCED]:
            for marking, silent in self._through_silence(way.marking, self._help(label)):
                for number in self._by_label[label]:
                    transition = self._transitions[number]
                    missing = _missing(marking, transition.inputs)
                    rank = (len(missing), len(silent))
                    if best is None or rank < best[:2]:
                        filled = list(marking)
                        for place in missing:
                            filled[place] += 1
                        after = _fired(tuple(filled), transition)
                        assert after is not None
                        best = (*rank, _Way(after, way, (*silent, number), tuple(missing)))
        assert best is not None
        return best[2]

    def _ended(self, way: _Way) -> _Way:
        known = self._ends.get(way.marking)
        if known is None:
            if len(self._ends) >= REMEMBERED:
                self._ends.clear()
            known = self._ends[way.marking] = self._nearest_end(way.marking)
        marking, silent = known
        pairs = list(enumerate(zip(marking, self._last, strict=True)))
        return _Way(
            self._last,
            way,
            silent,
            missing=tuple(place for place, (is_, wanted) in pairs if is_ < wanted),
            remaining=tuple(place for place, (is_, wanted) in pairs if is_ > wanted),
        )

    def _nearest_end(self, marking: Marking) -> tuple[Marking, tuple[int, ...]]:
        """Where silent transitions lead that is most like the final marking."""

        def amiss(found: tuple[Marking, tuple[int, ...]]) -> tuple[int, int]:
            marking, silent = found
            pairs = zip(marking, self._last, strict=True)
            return sum(abs(is_ - wanted) for is_, wanted in pairs), len(silent)

        return min(self._through_silence(marking, self._silent), key=amiss)

    def _help(self, label: str) -> frozenset[int]:
        """Silent transitions that can help to enable an activity: tokens of others stay."""
        if label not in self._helpful:
            wanted = {p for n in self._by_label[label] for p in self._transitions[n].inputs}
            helpful: set[int] = set()
            grown = True
            while grown:
                grown = False
                for number in self._silent:
                    transition = self._transitions[number]
                    if number not in helpful and wanted & set(transition.outputs):
                        helpful.add(number)
                        wanted |= set(transition.inputs)
                        grown = True
            self._helpful[label] = frozenset(helpful)
        return self._helpful[label]

    def _through_silence(
        self, marking: Marking, silent: frozenset[int]
    ) -> Iterator[tuple[Marking, tuple[int, ...]]]:
        """Markings that silent transitions lead to, the nearest first, and how."""
        seen = {marking}
        waiting: deque[tuple[Marking, tuple[int, ...]]] = deque([(marking, ())])
        while waiting:
            here, way = waiting.popleft()
            yield here, way
            for place, tokens in enumerate(here):
                for number in self._takes[place] if tokens else ():
                    if number not in silent:
                        continue
                    after = _fired(here, self._transitions[number])
                    if after is not None and after not in seen and len(seen) < MARKINGS_LOOKED_AT:
                        seen.add(after)
                        waiting.append((after, (*way, number)))


def _enabled(marking: Marking, transition: Transition) -> bool:
    inputs = transition.inputs
    return all(marking[place] >= inputs.count(place) for place in inputs)


def _missing(marking: Marking, inputs: Sequence[int]) -> list[int]:
    left = list(marking)
    missing: list[int] = []
    for place in inputs:
        if left[place]:
            left[place] -= 1
        else:
            missing.append(place)
    return missing


def _fired(marking: Marking, transition: Transition) -> Marking | None:
    if not _enabled(marking, transition):
        return None
    after = list(marking)
    for place in transition.inputs:
        after[place] -= 1
    for place in transition.outputs:
        after[place] += 1
    return tuple(after)
