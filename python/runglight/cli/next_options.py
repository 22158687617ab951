"""Options of watching with the network that foretells the next activity."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from cyclopts import Parameter

from runglight.errors import InputError

if TYPE_CHECKING:
    from runglight.process.next_activity import NextMonitor


@Parameter(name="*", group="Foretelling")
@dataclass(frozen=True, kw_only=True)
class NextOptions:
    """What is very unlikely at its point of a run is told too, as a notice."""

    next: Path | None = None
    "Network written by `runglight predict train`: activities it thought very unlikely are notices."
    net: Path | None = None
    "The net the network was trained with (PNML)."
    unlikely: float | None = None
    "Probability below which an activity is told (default: 0.01)."

    def monitor(self, state: Path | None) -> NextMonitor | None:
        """A monitor where one is asked for, from where `state` left off."""
        if self.next is None:
            if self.net is not None or self.unlikely is not None:
                option = "--unlikely" if self.net is None else "--net"
                raise InputError(f"{option}: is for a trained network; give that with --next")
            return None
        if self.net is None:
            raise InputError(f"--next: give the net {self.next} was trained with too: --net NET")
        # Loaded where it is asked for: most watching needs no network.
        from runglight.process.next_activity import UNLIKELY, load_next  # noqa: PLC0415
        from runglight.process.petri_net import read_net  # noqa: PLC0415

        unlikely = UNLIKELY if self.unlikely is None else self.unlikely
        if not 0 < unlikely < 1:
            raise InputError(f"--unlikely: {unlikely} must lie between 0 and 1")
        trained = load_next(self.next, read_net(self.net), str(self.net))
        reset = trained.training["events"].get("reset")
        if reset is None:
            raise InputError(f"{self.next}: does not tell where a run begins; train it anew")
        kept = None if state is None or not state.exists() else state.read_bytes()
        return trained.monitor(reset, unlikely=unlikely, state=kept)
