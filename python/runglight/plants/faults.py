"""Words for what can be done to a simulated plant, and for the truth about what was done."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

Transition = tuple[str, str]
"""Two signal-states in full, from and to: `Group1-PrtLDR-ADV_OFF`, `Group1-PrtLDR-RET_ON`."""


class FaultKind(StrEnum):
    """What is broken, and how."""

    SENSOR_STUCK_ON = "sensor-stuck-on"
    SENSOR_DEAD = "sensor-dead"
    SENSOR_GLITCH = "sensor-glitch"
    ACTUATOR_DEAD = "actuator-dead"
    ACTUATOR_SLOW = "actuator-slow"
    PART_PATTERN = "part-pattern"
    PROTECTION_TRIP = "protection-trip"
    JAM = "jam"


@dataclass(frozen=True, slots=True)
class FaultDescription:
    """A fault a plant offers, and how a watcher of its change log gets to see it.

    `faulty` is the transition it shows in: an unknown one if there are `expected` ones in its
    place, else a known one in the wrong time (`expected_s` is the nominal maximum, seconds) or
    with the wrong share. A fault without it stops the line, in `last_state`.
    """

    number: int
    name: str
    sentence: str
    kind: FaultKind
    group: str
    device: str
    signal: str
    faulty: Transition | None = None
    expected: tuple[Transition, ...] = ()
    expected_s: float | None = None
    last_state: str | None = None


@dataclass(frozen=True, slots=True)
class FaultLabel:
    """The truth about one fault of one run.

    `time_ns` is when the fault began; `shown_ns` is the log row that first shows it (for a stop:
    the last row before the silence), and `observed_s` is the time its transition took (for a
    stop: how long the silence lasted). Both are None if the run ended before it could show.
    """

    number: int
    name: str
    time_ns: int
    group: str
    device: str
    signal: str
    kind: FaultKind
    description: str
    faulty: Transition | None
    expected: tuple[Transition, ...]
    expected_s: float | None
    last_state: str | None
    shown_ns: int | None
    observed_s: float | None


def label_of(
    fault: FaultDescription,
    began_ns: int,
    shown_ns: int | None = None,
    observed_s: float | None = None,
) -> FaultLabel:
    """What is told about a fault of a run."""
    return FaultLabel(
        number=fault.number,
        name=fault.name,
        time_ns=began_ns,
        group=fault.group,
        device=fault.device,
        signal=fault.signal,
        kind=fault.kind,
        description=fault.sentence,
        faulty=fault.faulty,
        expected=fault.expected,
        expected_s=fault.expected_s,
        last_state=fault.last_state,
        shown_ns=shown_ns,
        observed_s=observed_s,
    )


def find_fault(faults: Mapping[int, FaultDescription], choice: int | str) -> FaultDescription:
    """A fault by its number (also as text) or its name; ValueError if the plant has no such."""
    for fault in faults.values():
        if choice in (fault.number, str(fault.number), fault.name):
            return fault
    known = ", ".join(f"{fault.number} {fault.name}" for fault in faults.values())
    raise ValueError(f"this plant has no fault {choice!r}; it has {known}")
