"""The two case studies of Cadiou 2019 on the simulated bottling machine, recorded over Modbus TCP.

The paper's protocol (section 4.1): 100 `%M` and 300 `%MW` read once a second for three minutes, in
production to find the counter of parts, and with the conveyor started and stopped by hand to find
the conveyor.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import inf
from pathlib import Path
from random import Random

import numpy as np
import numpy.typing as npt

from runglight.log.changelog import Log
from runglight.plants.agenda import NS_PER_S, nanoseconds
from runglight.plants.bottling import CONVEYOR, PARTS, Meaning, RunningBottling, Sight
from runglight.plants.bottling.simulate import START_NS
from runglight.recording.meter import Meter
from runglight.recording.read import open_recording
from runglight.recording.recorder import Recorder
from runglight.recording.run import record
from runglight.softplc import SoftPlc, serve
from runglight.taps import open_tap
from runglight.taps.virtual_clock import VirtualClock

SCAN_NS = NS_PER_S
WARM_UP_S = 60.0
"""The line is full when recording begins."""


@dataclass(frozen=True, slots=True)
class Case:
    """What is looked for, and how."""

    name: str
    meaning: Meaning
    tau_s: float
    production_s: float
    """From one manual phase to the next. In three minutes the conveyor case has about two: what
    tells the conveyor from the panel's buttons is only that it starts by itself after each."""


CASES = {
    "parts": Case("parts", PARTS, 10.0, inf),
    "conveyor": Case("conveyor", CONVEYOR, 4.0, 28.0),
}

Integers = npt.NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Recorded:
    """One recording of the machine, and what was to be seen meanwhile."""

    log: Log
    scan_ns: Integers
    sights: tuple[Sight, ...]
    """What happened, whether anybody noticed or not."""


Aside = Callable[[SoftPlc, VirtualClock], None]
"""Begins something beside a recording, a photographer for example."""


async def recorded(
    case: Case, seed: int, directory: Path, minutes: float = 3.0, aside: Aside | None = None
) -> Recorded:
    """Records the machine into a directory: soft PLC, Modbus TCP, tap, recorder.

    Simulated time: it stands still while anybody works, and the machine is where the scan says.
    """
    clock = VirtualClock(START_NS)
    plant = RunningBottling(START_NS, seed, production_s=case.production_s)
    begins_s = WARM_UP_S + Random(f"{seed}/recording").uniform(0.0, 1.0)
    async with serve(plant, "modbus://127.0.0.1:0", clock) as plc:
        clock.advance_to(START_NS + nanoseconds(begins_s))
        # A computer at its limits is no lost connection.
        url = plc.tap_url.replace("10ms", "1s&timeout=60s")
        async with open_tap(url, clock=clock) as tap:
            if aside is not None:
                aside(plc, clock)
            with Recorder(directory, tap, reserve_bytes=0) as recorder:
                await record(tap, recorder, meter=Meter(SCAN_NS), for_s=60.0 * minutes)
    recording = open_recording(directory)
    first_ns, last_ns = int(recording.scan_ns[0]), int(recording.scan_ns[-1])
    sights = tuple(sight for sight in plant.sights if first_ns <= sight.time_ns <= last_ns)
    return Recorded(recording.log, recording.scan_ns, sights)
