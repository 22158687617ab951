"""What `runglight record` shows while it records, and what it says at the end."""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from rich.console import Console
from rich.live import Live
from rich.table import Table
from rich.text import Text

from runglight import environment
from runglight.cli import terminal
from runglight.cli.counted import counted
from runglight.taps.base import Connection, ConnectionState

if TYPE_CHECKING:
    from types import TracebackType
    from typing import Self

    from runglight.recording.camera import Camera
    from runglight.recording.meter import Meter
    from runglight.recording.recorder import Recorder
    from runglight.taps.base import Tap

_STYLES = {
    ConnectionState.CONNECTED: "green",
    ConnectionState.CONNECTING: "yellow",
    ConnectionState.RETRYING: "bold red",
    ConnectionState.CLOSED: "dim",
}


@dataclass
class RecordStatus:
    """A table that is kept up to date on a terminal; elsewhere, notes when something changes."""

    tap: Tap
    recorder: Recorder
    meter: Meter
    camera: Camera | None = None
    _live: Live | None = None
    _said: Connection = field(default_factory=Connection)
    _camera_said: str | None = None

    def __enter__(self) -> Self:
        if sys.stderr.isatty() and not environment.unattended():
            self._live = Live(
                self.table(), console=Console(file=sys.stderr), auto_refresh=False, transient=True
            )
            self._live.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._live is not None:
            self._live.stop()

    def tick(self) -> None:
        """Shows what has changed."""
        if self._live is not None:
            self._live.update(self.table(), refresh=True)
            return
        connection, before = self.tap.connection, self._said
        if connection.state is not before.state:
            self._said = connection
            reason = f": {connection.reason}" if connection.reason else ""
            terminal.note(f"{self.tap.url}: {connection.state}{reason}")
        trouble = None if self.camera is None else self.camera.trouble
        if trouble != self._camera_said:
            self._camera_said = trouble
            terminal.note(trouble or "photos come again")

    def table(self) -> Table:
        """Everything at a glance."""
        meter, recorder, connection = self.meter, self.recorder, self.tap.connection
        table = Table.grid(padding=(0, 2))
        table.add_column(style="dim")
        table.add_column(overflow="fold")
        state = Text(str(connection.state), _STYLES[connection.state])
        if connection.reason:
            state.append(f": {connection.reason}", "default")
        table.add_row("source", Text.assemble(self.tap.url, "  ", state))
        table.add_row("recorded", f"{meter.recorded_s:,.0f} s to {recorder.directory}")
        table.add_row("scans", self._scans())
        table.add_row("changes", f"{meter.changes_per_s:,.0f} per second")
        table.add_row("rows", f"{recorder.rows:,}")
        table.add_row("reconnects", f"{connection.reconnects:,}")
        if self.camera is not None:
            photos = Text(f"{self.camera.taken:,}")
            if self.camera.trouble:
                photos.append(f"  {self.camera.trouble}", "bold red")
            table.add_row("photos", photos)
        table.add_row("free disk", f"{recorder.free_bytes / 1e9:,.1f} GB")
        return table

    def _scans(self) -> str:
        jitter_ms = self.meter.jitter_p99_ms
        if jitter_ms is None:
            return "none (the source sends by itself)" if self.meter.recorded_s else "none yet"
        return f"{self.meter.scans_per_s:,.0f} per second, 99 % within {jitter_ms:.2f} ms of time"

    def summary(self) -> str:
        """What was recorded, in one sentence."""
        recorder = self.recorder
        parts = [counted(recorder.rows, "row")]
        if recorder.scans:
            parts.append(counted(recorder.scans, "scan"))
        if self.camera is not None:
            parts.append(counted(self.camera.taken, "photo"))
        if self.tap.connection.reconnects:
            parts.append(counted(self.tap.connection.reconnects, "reconnect"))
        return (
            f"{recorder.directory}: recorded {', '.join(parts)} of "
            f"{counted(len(self.tap.signals), 'signal')} in {self.meter.recorded_s:,.1f} s"
        )
