"""Options of the commands that need runs: how a log is cut into them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cyclopts import Parameter

from runglight.cli.reader_options import ReaderOptions, read
from runglight.errors import InputError
from runglight.process.event_log import EventLog, event_log

if TYPE_CHECKING:
    from collections.abc import Mapping


@Parameter(name="*", group="Runs")
@dataclass(frozen=True, kw_only=True)
class RunOptions:
    """How a log is cut into runs."""

    reset: str | None = None
    "Change that opens a run: `%IX0.1=0`, several at one time joined by `&`."
    only: tuple[str, ...] = ()
    "Signal that takes part; repeat it, or join with commas (default: all)."
    keep_partial: bool = False
    "Keep what lies before the first reset and after the last one."

    def over(self, kept: Mapping[str, Any]) -> RunOptions:
        """These options over what a network was trained with."""
        return RunOptions(
            reset=self.reset or kept.get("reset"),
            only=self.only or tuple(kept.get("only", ())),
            keep_partial=self.keep_partial or bool(kept.get("keep_partial", False)),
        )

    def kept(self) -> dict[str, Any]:
        """What is kept with a network."""
        return {
            "reset": self.reset,
            "only": list(self.signals),
            "keep_partial": self.keep_partial,
        }

    @property
    def signals(self) -> list[str]:
        """Signals that take part; none: all."""
        return [name.strip() for text in self.only for name in text.split(",") if name.strip()]


def read_runs(log: Path, options: ReaderOptions, runs: RunOptions) -> EventLog:
    """Reads a log and cuts it into runs."""
    if runs.reset is None:
        raise InputError(
            f"{log}: where does a run begin? name the change that opens it: --reset %IX0.1=0"
        )
    configuration = options.configuration()
    return event_log(
        read(log, configuration.log),
        reset=runs.reset,
        symbols=configuration.symbols.table,
        naming=configuration.symbols.naming,
        keep_partial=runs.keep_partial,
        only=runs.signals,
    )
