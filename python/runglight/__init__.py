"""runglight learns how a PLC-controlled machine behaves and says what departs from it.

    import runglight as rl

    log = rl.read_log("cell.csv")
    model = rl.learn(log)
    model.save("cell.model")
    for finding in rl.load_model("cell.model").watch(rl.read_log("today.csv")):
        print(finding["time"], finding["message"])

Everything public is a name of this package; it is loaded when it is first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from runglight._engine import __version__
    from runglight.configuration import Parameters
    from runglight.cycle_model import CycleModel
    from runglight.errors import InputError, ModelError, RunglightError
    from runglight.findings.batch import Findings
    from runglight.findings.schema import finding_schema
    from runglight.log.changelog import Log, read_log
    from runglight.log.options import ReadOptions
    from runglight.model import Monitor, NominalModel, learn, learn_cycle, load_model
    from runglight.process.event_log import EventLog, event_log
    from runglight.process.next_activity import (
        NextActivity,
        NextMonitor,
        TrainingSettings,
        load_next,
        train_next,
    )
    from runglight.process.petri_net import PetriNet, read_net

__all__ = [
    "CycleModel",
    "EventLog",
    "Findings",
    "InputError",
    "Log",
    "ModelError",
    "Monitor",
    "NextActivity",
    "NextMonitor",
    "NominalModel",
    "Parameters",
    "PetriNet",
    "ReadOptions",
    "RunglightError",
    "TrainingSettings",
    "__version__",
    "event_log",
    "finding_schema",
    "learn",
    "learn_cycle",
    "load_model",
    "load_next",
    "read_log",
    "read_net",
    "train_next",
]

# Where each public name lives. A plain `import runglight` loads none of these rooms, so that the
# command line answers `--help` at once.
_HOMES = {
    "CycleModel": "runglight.cycle_model",
    "EventLog": "runglight.process.event_log",
    "Findings": "runglight.findings.batch",
    "InputError": "runglight.errors",
    "Log": "runglight.log.changelog",
    "ModelError": "runglight.errors",
    "Monitor": "runglight.model",
    "NextActivity": "runglight.process.next_activity",
    "NextMonitor": "runglight.process.next_activity",
    "NominalModel": "runglight.model",
    "Parameters": "runglight.configuration",
    "PetriNet": "runglight.process.petri_net",
    "ReadOptions": "runglight.log.options",
    "RunglightError": "runglight.errors",
    "TrainingSettings": "runglight.process.next_activity",
    "__version__": "runglight._engine",
    "event_log": "runglight.process.event_log",
    "finding_schema": "runglight.findings.schema",
    "learn": "runglight.model",
    "learn_cycle": "runglight.model",
    "load_model": "runglight.model",
    "load_next": "runglight.process.next_activity",
    "read_log": "runglight.log.changelog",
    "read_net": "runglight.process.petri_net",
    "train_next": "runglight.process.next_activity",
}


def __getattr__(name: str) -> object:
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module 'runglight' has no attribute {name!r}")
    return getattr(import_module(home), name)


def __dir__() -> list[str]:
    return sorted(__all__)
