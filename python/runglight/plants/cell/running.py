"""The cell at work without an end, with faults switched on meanwhile."""

from collections.abc import Mapping, Sequence
from itertools import chain

from runglight.plants.agenda import NS_PER_S
from runglight.plants.cell.controller import CellController
from runglight.plants.cell.faults import FAULTS, FAULTS_AT_WORK
from runglight.plants.cell.feeding import PART_INTERVALS_S, PartFeed
from runglight.plants.cell.injector import TRIGGERS, TRIGGERS_AT_WORK, FaultInjector
from runglight.plants.cell.labels import Showing
from runglight.plants.cell.plant import CellPlant
from runglight.plants.cell.symbols import OUTPUTS, SYMBOLS
from runglight.plants.faults import FaultDescription, FaultLabel, find_fault, label_of
from runglight.plants.scanned import ScannedPlant


class RunningCell(ScannedPlant[bool]):
    """A `RunningPlant`: the cell, fed with parts for ever.

    Its changes are those of `simulate_cell` with the same seed and intervals, as long as that has
    parts. A fault begins at the next moment of the work at which it is possible: at most some
    two minutes after it was asked for.
    """

    def __init__(
        self,
        start_ns: int,
        seed: int = 1,
        *,
        part_intervals_s: Sequence[float] = PART_INTERVALS_S,
    ) -> None:
        self._plant = CellPlant(start_ns, seed, PartFeed(part_intervals_s))
        super().__init__(
            SYMBOLS,
            self._plant,
            CellController(),
            start_ns=start_ns,
            outputs=(False,) * len(OUTPUTS),
        )
        self._start_ns = start_ns
        self._switched_on = False
        self._injected: list[tuple[FaultInjector, Showing]] = []
        self.on_change(self._watch)

    @property
    def faults(self) -> Mapping[int, FaultDescription]:
        """The twelve faults of Ghosh 2016, Table 4."""
        return FAULTS

    @property
    def cycles(self) -> int:
        """Parts set on the loader so far."""
        return self._plant.parts_set

    def advance(self, now_ns: int) -> None:
        """Runs every PLC scan due by `now_ns`."""
        if not self._switched_on and now_ns >= self._start_ns:
            self._switched_on = True
            self._plant.power_on()
        super().advance(now_ns)

    def inject(self, fault: int | str, at_ns: int | None = None) -> FaultDescription:
        """Breaks something at the next possible moment after `at_ns` (None: now)."""
        chosen = find_fault(FAULTS, fault)
        for each in chain(self.waiting(), self.acting()):
            if each.number == chosen.number:
                raise ValueError(f"fault {chosen.number} {chosen.name} is there already")
        armed_ns = self.now_ns if at_ns is None else max(at_ns, self.now_ns)
        if self._switched_on or armed_ns > self._start_ns:
            description = FAULTS_AT_WORK[chosen.number]
            injector = FaultInjector(
                self._plant, description, TRIGGERS_AT_WORK[chosen.number], armed_ns=armed_ns
            )
        else:
            description = chosen
            injector = FaultInjector(self._plant, description, TRIGGERS[chosen.number])
        self._injected.append((injector, Showing(description)))
        return description

    def labels(self) -> tuple[FaultLabel, ...]:
        """The truth about every fault that has begun, in the order of their beginnings."""
        labels = [
            label_of(injector.fault, injector.began_ns, showing.shown_ns, self._observed_s(showing))
            for injector, showing in self._injected
            if injector.began_ns is not None
        ]
        return tuple(sorted(labels, key=lambda label: label.time_ns))

    def waiting(self) -> tuple[FaultDescription, ...]:
        """Faults injected that have not begun yet."""
        return tuple(each.fault for each, _ in self._injected if each.began_ns is None)

    def acting(self) -> tuple[FaultDescription, ...]:
        """Faults that have begun and not passed."""
        return tuple(
            each.fault
            for each, _ in self._injected
            if each.began_ns is not None and not each.passed
        )

    def _observed_s(self, showing: Showing) -> float | None:
        """The time of the transition that showed it; of a stop, how long it is silent by now."""
        if showing.observed_s is None and showing.shown_ns is not None:
            return (self.now_ns - showing.shown_ns) / NS_PER_S
        return showing.observed_s

    def _watch(self, time_ns: int, number: int, value: int) -> None:
        for injector, showing in self._injected:
            showing.row(time_ns, number, value, injector.began_ns)
