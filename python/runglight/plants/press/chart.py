"""What the press does in a cycle, as its sequential function chart."""

from dataclasses import dataclass, field, replace

from runglight.plants.press.symbols import CARRIAGES

CLAMPS = tuple(f"Clamp{number}" for number in range(1, 7))
PUNCHES = tuple(f"Punch{number}" for number in range(1, 5))
DRILLS = ("Drill1", "Drill2", "Drill3")

PARTS_WITHIN_S = 900.0
"""Without a part for so long the machine shows that it stands."""


@dataclass(frozen=True, slots=True)
class Step:
    """Switches outputs, then waits until inputs are as they should be.

    `watchdog_s` is how long that may take before the HMI shows an alarm; None: for ever.
    `work` is what the work-complete bit says meanwhile.
    """

    work: bool
    switch: dict[str, bool]
    until: tuple[tuple[str, bool], ...]
    watchdog_s: float | None = 5.0
    pause_s: float = 0.0
    held: dict[str, str] = field(default_factory=dict)
    """Actuators that have arrived, and the sensor that has to stay on."""
    waits_for_parts: bool = False
    """Its watchdog tells of no failure: the line before this machine has run dry."""


_Move = tuple[str, bool]


_VALVE = {True: "ADV", False: "RET"}


def _out(*devices: str) -> tuple[_Move, ...]:
    return tuple((device, True) for device in devices)


def _back(*devices: str) -> tuple[_Move, ...]:
    return tuple((device, False) for device in devices)


class _Draft:
    """Collects steps, and remembers where every actuator stands."""

    def __init__(self) -> None:
        self.steps: list[Step] = []
        self.work = True
        self.held: dict[str, str] = {}

    def step(
        self,
        *moves: _Move,
        switch: dict[str, bool] | None = None,
        until: tuple[tuple[str, bool], ...] = (),
        watchdog_s: float | None = 5.0,
        pause_s: float = 0.0,
        waits_for_parts: bool = False,
    ) -> None:
        switched = dict(switch or {})
        conditions = list(until)
        for device, out in moves:
            self.held.pop(device, None)
            output = "FORWARD" if device in CARRIAGES else "VALVE"
            switched[f"{device}-{output}"] = out
            conditions.append((f"{device}-{_VALVE[out]}", True))
            conditions.append((f"{device}-{_VALVE[not out]}", False))
        self.steps.append(
            Step(
                work=self.work,
                switch=switched,
                until=tuple(conditions),
                watchdog_s=watchdog_s,
                pause_s=pause_s,
                held=dict(self.held),
                waits_for_parts=waits_for_parts,
            )
        )
        for device, out in moves:
            self.held[device] = f"{device}-{_VALVE[out]}"

    def ring(self) -> tuple[Step, ...]:
        """What the end of the chart has reached is held when it begins again."""
        first = dict(self.held)
        ring: list[Step] = []
        for step in self.steps:
            for output in step.switch:
                first.pop(output.split("-")[0], None)
            ring.append(replace(step, held=first | step.held))
        return tuple(ring)


def _work(draft: _Draft) -> None:
    step = draft.step
    step(*_out(*CLAMPS[:4]))
    step(*_out("Clamp5", "Clamp6", "Pin1", "Pin2"), until=(("Relays-UNCLAMPED", False),))
    step(
        switch={"Inverter-RUN": True},
        until=(("Relays-CLAMPED", True), ("Inverter-AT_SPEED", True)),
    )
    step(*_back("Index"))
    step(*_out("Table"), until=(("Relays-TABLE_LOCKED", False),), watchdog_s=7.0)
    step(*_out("Index"))
    step(
        switch={"Hydraulics-LOAD": True},
        until=(("Hydraulics-PRESSURE", True), ("Relays-TABLE_LOCKED", True)),
    )
    step(*_out(*PUNCHES), pause_s=0.6)
    step(*_back(*PUNCHES), switch={"Hydraulics-LOAD": False})
    step(*_out(*DRILLS), until=(("Hydraulics-PRESSURE", False),), watchdog_s=8.0)
    step(*_back(*DRILLS))
    step(*_out("Tap1", "Tap2"), watchdog_s=6.0)
    step(*_back("Tap1", "Tap2"))
    step(
        *_back("Index"),
        switch={"Inverter-RUN": False},
        until=(("Relays-TOOLS_HOME", True), ("Inverter-STANDSTILL", True)),
    )
    step(*_back("Table"), watchdog_s=7.0)
    step(*_out("Index"))
    step(*_back("Pin1", "Pin2"), pause_s=0.4)


def _set_up(draft: _Draft) -> None:
    step = draft.step
    step(*_back(*CLAMPS), until=(("Relays-PINS_IN", False),))
    step(*_back("Guard"), until=(("Relays-UNCLAMPED", True),))
    step(*_out("Eject1", "Eject2"))
    step(*_out("Removal"))
    step(*_out("Grip1"), until=(("Removal-PART_ON", True),))
    step(*_back("Eject1", "Eject2"))
    step(*_back("Removal"))
    step(*_back("Grip1"), switch={"Outfeed-BELT": True}, until=(("Removal-PART_ON", False),))
    step(until=(("Outfeed-EXIT", True),), watchdog_s=8.0)
    step(
        switch={"Infeed-BELT": True},
        until=(("Infeed-WAITING", True),),
        watchdog_s=PARTS_WITHIN_S,
        waits_for_parts=True,
    )
    step(*_back("Stop1"), until=(("Infeed-AT_STOP", True),), watchdog_s=8.0)
    step(
        *_out("Stop1", "Lift1", "Lift2"),
        switch={"Infeed-BELT": False, "Outfeed-BELT": False},
    )
    step(*_out("Grip2"), until=(("Transfer-PART_ON", True),))
    step(*_out("Transfer"))
    step(*_out("Slide1", "Slide2"))
    step(*_back("Grip2"), until=(("Transfer-PART_ON", False),))
    step(*_back("Transfer"))
    step(*_back("Lift1", "Lift2", "Slide1", "Slide2"))
    step(*_out("Centre1", "Centre2"))
    step(*_back("Centre1", "Centre2"))
    step(*_out("Guard"), switch={"OilPump-LUBRICATE": True}, until=(("OilPump-FLOW", True),))
    step(
        switch={"OilPump-LUBRICATE": False},
        until=(("OilPump-FLOW", False), ("Relays-PRESS_FREE", True)),
        pause_s=0.5,
    )


def _steps() -> tuple[Step, ...]:
    draft = _Draft()
    _work(draft)
    draft.work = False
    _set_up(draft)
    return draft.ring()


STEPS = _steps()

AT_START = {"Guard-VALVE": True, "Index-VALVE": True, "Stop1-VALVE": True, "Stop2-VALVE": False}
"""Outputs that are ON when the shift begins; the machine stands ready for its first part."""
