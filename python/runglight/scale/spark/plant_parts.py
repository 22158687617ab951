"""The parts of a plant that are watched apart, each under its own key of the stream."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from runglight.model import Monitor, NominalModel

WHOLE = ""
"""Name of the only part of a plant that cannot be cut."""


class PlantParts:
    """A model cut into parts; which one a signal belongs to, and the monitor of each.

    A part is one group, or the groups whose transitions wait for one another's events, and is named
    after them: `Group1`, `Group2+Group3`.
    """

    def __init__(self, model: NominalModel) -> None:
        cut = model.parts()
        self._model = model
        self._groups = cut if len(cut) > 1 else []
        self.names: tuple[str, ...] = tuple(map("+".join, self._groups)) or (WHOLE,)
        self._of_group = {
            group: part for part, groups in enumerate(self._groups) for group in groups
        }
        self._loaded: dict[str, NominalModel] = {}

    @property
    def several(self) -> bool:
        """Whether there is more than one part."""
        return bool(self._groups)

    @property
    def first(self) -> str:
        """The part that holds the plant's first group; it tells what all know."""
        return self.names[self._of_group[self._model.groups[0]]] if self._groups else WHOLE

    def of_signals(self, signals: Sequence[str]) -> list[int]:
        """Indices of the parts of some signals; what the model does not know is the first's."""
        if not self._groups:
            return [0] * len(signals)
        first = self.names.index(self.first)
        return [
            first if group is None else self._of_group[group]
            for group in self._model.groups_of(signals)
        ]

    def monitor(self, name: str, state: bytes | None) -> Monitor:
        """The monitor of a part."""
        model = self._loaded.get(name)
        if model is None:
            model = (
                self._model.part(self._groups[self.names.index(name)])
                if self._groups
                else self._model
            )
            self._loaded[name] = model
        return model.monitor(state)
