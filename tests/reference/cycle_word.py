"""Mode `word` of the cycle machine once more, from Guim & Dias 2023 alone and as slow as it reads.

One region; what is compared is the sequences learned and the first line of every finding.
"""

from collections import Counter, defaultdict
from dataclasses import dataclass, field
from itertools import pairwise

Reading = tuple[int, int, int, int]
"""Word, work-complete, manual, alarm: what one scan shows."""


@dataclass
class Machine:
    """Section 3.4: states, and how often each transition was seen."""

    initial: Counter[int] = field(default_factory=Counter)
    final: Counter[int] = field(default_factory=Counter)
    weights: dict[int, Counter[int]] = field(default_factory=lambda: defaultdict(Counter))

    @property
    def states(self) -> set[int]:
        """All words seen."""
        onwards = {word for counts in self.weights.values() for word in counts}
        return set(self.initial) | set(self.final) | set(self.weights) | onwards


def rows(readings: list[Reading]) -> list[tuple[int, list[int], bool]]:
    """Section 3.3: (work-complete, words, paused) of every row, before cleaning."""
    told: list[tuple[int, list[int], bool]] = []
    for word, work, manual, alarm in readings:
        if not told or told[-1][0] != work:
            told.append((work, [word], False))
        elif told[-1][1][-1] != word:
            told[-1][1].append(word)
        if manual or alarm:
            told[-1] = (told[-1][0], told[-1][1], True)
    return told


def learn(readings: list[Reading]) -> dict[int, Machine]:
    """The machines of work (1) and set-up (0), of what cleaning leaves."""
    machines = {0: Machine(), 1: Machine()}
    told = rows(readings)
    for work, machine in machines.items():
        file = [row for row in told if row[0] == work]
        for place, (_, words, _) in enumerate(file):
            if place in (0, len(file) - 1):
                continue
            if any(paused for _, _, paused in file[place - 1 : place + 2]):
                continue
            machine.initial[words[0]] += 1
            machine.final[words[-1]] += 1
            for before, after in pairwise(words):
                machine.weights[before][after] += 1
    return machines


def candidates(possible: Counter[int], seen: int, width: int) -> list[tuple[int, float]]:
    """Section 3.6, with similarity by equal bits: words and final scores, best first."""
    total = sum(possible.values())
    scored = []
    for word, weight in possible.items():
        equal = sum((word >> bit & 1) == (seen >> bit & 1) for bit in range(width))
        scored.append((2 * equal / width + weight / total, weight, word))
    scored.sort(key=lambda each: (-each[0], -each[1], each[2]))
    return [(word, score) for score, _, word in scored]


@dataclass
class Found:
    """A finding: at which reading, of what kind, and the prediction with its score."""

    place: int
    kind: str
    at: int | None
    seen: int
    predicted: list[int]


def watch(machines: dict[int, Machine], readings: list[Reading], width: int) -> list[Found]:
    """Section 3.5: the findings of one region, without alarms."""
    found: list[Found] = []
    here: int | None = None
    lost = True
    joined = False
    by_hand = False
    work_before: int | None = None
    for place, (word, work, manual, _) in enumerate(readings):
        edge = work_before is not None and work != work_before
        machine = machines[work]
        first = work_before is None
        old, work_before = work_before, work
        if manual:
            by_hand, lost, here = True, True, None
            continue
        back, by_hand = by_hand, False
        # As learning leaves out a sequence with a pause, so does watching.
        joined = not back and (joined or edge)
        if edge and joined:
            told = False
            if not lost and here not in machines[old or 0].final:
                kept = machines[old or 0].final
                ranked = [each for each, _ in candidates(kept, here or 0, width)]
                found.append(Found(place, "sequence", here, here or 0, ranked))
                told = True
            known = machine.states
            if known and word not in machine.initial and not told:
                ranked = [each for each, _ in candidates(machine.initial, word, width)]
                found.append(Found(place, "start_state", None, word, ranked))
            lost = word not in known
            here = None if lost else word
        elif first or back:
            continue
        elif lost:
            if joined and word in machine.states:
                lost, here = False, word
        elif word != here:
            onwards = machine.weights[here or 0] if here in machine.weights else Counter()
            if word not in onwards:
                possible = onwards or Counter({here or 0: 1})
                ranked = [each for each, _ in candidates(possible, word, width)]
                found.append(Found(place, "sequence", here, word, ranked))
                lost = word not in machine.states
            here = None if lost else word
    return found
