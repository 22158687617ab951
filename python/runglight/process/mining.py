"""Mining: from the runs of a machine to the net they follow (Split Miner)."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import msgspec

from runglight import _engine
from runglight.configuration import Mining
from runglight.process.petri_net import PetriNet
from runglight.strictly import convert

if TYPE_CHECKING:
    from os import PathLike

    from runglight.process.event_log import EventLog


class MinedProcess:
    """What was mined: a Petri net, and the same as tasks and gateways."""

    def __init__(self, engine_mined: _engine.Mined) -> None:
        self._engine = engine_mined
        self.net = PetriNet(engine_mined.net)

    @property
    def epsilon(self) -> float:
        """The ε in force: another than asked for where that gave a net that is not sound."""
        return self._engine.epsilon

    def write_bpmn(self, path: str | PathLike[str]) -> None:
        """Writes BPMN 2.0; the file appears whole or not at all."""
        self._engine.write_bpmn(os.fspath(path))


def mine(log: EventLog, *, eta: float = 0.0, epsilon: float = 0.5) -> MinedProcess:
    """Mines an event log with Split Miner.

    Parameters
    ----------
    log
        The runs: `runglight.event_log`, or `runglight.read_event_log` for XES.
    eta
        η, from 0 to 1: how much of what is rare is filtered out; 0 keeps everything.
    epsilon
        ε, from 0 to 1: imbalance of two orders from which on they are not concurrent.

    """
    parameters = convert({"eta": eta, "epsilon": epsilon}, Mining, "mine")
    return MinedProcess(_engine.mine(log.engine, msgspec.json.encode(parameters).decode()))
