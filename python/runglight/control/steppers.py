"""The learned controller and its shadow, as the scan loop drives them."""

from collections.abc import Callable

from runglight import _engine
from runglight.control.link import Image
from runglight.control.loop import Writes

Tell = Callable[[list[str]], None]
"""Takes findings, one JSON text each."""


class InControl:
    """Writes what the learned controller decides; once it has given up, its safe state."""

    def __init__(self, controller: _engine.Controller, tell: Tell) -> None:
        self.controller = controller
        self._tell = tell
        self.writes = 0
        """Outputs written so far."""

    @property
    def gave_up(self) -> bool:
        """Whether the plant has left the net."""
        return self.controller.mode == "safe"

    def step(self, now_ns: int, image: Image) -> Writes:
        """One scan."""
        writes, findings = self.controller.scan(now_ns, image)
        if len(findings):
            self._tell(findings.json_lines())
        self.writes += len(writes)
        return writes

    def lost(self, now_ns: int, reason: str) -> None:
        """What the plant does meanwhile shows in the next scan."""

    def farewell(self) -> Writes:
        """The safe state, unless nothing has been controlled."""
        return [] if self.controller.mode == "starting" else self.controller.safe


class Beside:
    """Writes nothing."""

    def __init__(self, shadow: _engine.Shadow, tell: Tell) -> None:
        self.shadow = shadow
        self._tell = tell

    def step(self, now_ns: int, image: Image) -> Writes:
        """One scan."""
        findings = self.shadow.scan(now_ns, image)
        if len(findings):
            self._tell(findings.json_lines())
        return []

    def lost(self, now_ns: int, reason: str) -> None:
        """It waits for the next run to open."""
        del now_ns, reason
        self.shadow.gap()

    def farewell(self) -> Writes:
        """Nothing."""
        return []
