"""Live activities: changes of one class at one time (Theis 2019, Algorithm 1), as they come."""

from __future__ import annotations

from typing import TYPE_CHECKING

from runglight.taps.base import Gap

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from runglight.taps.base import Batch

ORDER = ("input", None, "output")
"""Of one scan: a program reads, computes and writes."""


class LiveActivities:
    """Turns batches of a tap into activities of the signals of a net.

    `number_of` says which tap signal is which of the net's, by index; `classes` holds the class of
    each of the net's signals. Whole scans come in one batch, so nothing waits for the next.
    """

    def __init__(
        self, number_of: Callable[[int], str | None], classes: Mapping[str, str | None]
    ) -> None:
        self._signal = number_of
        self._classes = classes
        self.values: dict[str, int] = {}
        """As they stand, by the net's names."""

    def take(self, batch: Batch) -> Iterator[tuple[int, list[str]]]:
        """The time of every scan that changed something, and its activities.

        `values` are as they stood after that scan while it is looked at. An image, and what comes
        first of a signal, is no change.
        """
        if any(isinstance(mark, Gap) for mark in batch.marks):
            self.values.clear()
        rows = list(
            zip(
                batch.time_ns.tolist(),
                batch.signal_index.tolist(),
                batch.value.tolist(),
                strict=True,
            )
        )
        start = 0
        while start < len(rows):
            time_ns = rows[start][0]
            end = start
            changes: list[tuple[str, int]] = []
            while end < len(rows) and rows[end][0] == time_ns:
                _, index, value = rows[end]
                end += 1
                name = self._signal(index)
                if name is None:
                    continue
                before = self.values.get(name)
                self.values[name] = value
                if before is not None and before != value and not batch.image:
                    changes.append((name, value))
            start = end
            if changes:
                yield time_ns, self._activities(changes)

    def _activities(self, changes: list[tuple[str, int]]) -> list[str]:
        found: list[str] = []
        for kind in ORDER:
            merged: dict[str, int] = {}
            for name, value in changes:
                if self._classes.get(name) != kind:
                    continue
                if name in merged:
                    found.append(_name(merged))
                    merged = {}
                merged[name] = value
            if merged:
                found.append(_name(merged))
        return found


def _name(changes: Mapping[str, int]) -> str:
    return " & ".join(f"{name}={changes[name]}" for name in sorted(changes))
