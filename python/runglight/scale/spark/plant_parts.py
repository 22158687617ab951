"""The parts of a plant that are watched apart, each under its own key of the stream."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from runglight.model import Monitor, NominalModel

WHOLE = ""


class PlantParts:
    """A model cut into parts; which one a signal belongs to, and the monitor of each."""

    def __init__(self, model: NominalModel) -> None:
        self._model = model
        self.names: tuple[str, ...] = (WHOLE,)

    def of_signal(self, signal: str) -> int:
        """Index of the part of a signal, known to the model or not."""
        return 0

    def monitor(self, name: str, state: bytes | None) -> Monitor:
        """The monitor of a part."""
        return self._model.monitor(state)
