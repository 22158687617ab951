"""What the press does in a cycle, as its sequential function chart."""

from dataclasses import dataclass, field

CLAMPS = tuple(f"Clamp{number}" for number in range(1, 7))
PUNCHES = tuple(f"Punch{number}" for number in range(1, 5))
DRILLS = ("Drill1", "Drill2", "Drill3")


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


_Move = tuple[str, bool]
_VALVE = {True: "ADV", False: "RET"}


def _steps() -> tuple[Step, ...]:
    steps: list[Step] = []
    held: dict[str, str] = {}
    work = True

    def step(
        *moves: _Move,
        switch: dict[str, bool] | None = None,
        until: tuple[tuple[str, bool], ...] = (),
        watchdog_s: float | None = 5.0,
        pause_s: float = 0.0,
    ) -> None:
        switched = dict(switch or {})
        conditions = list(until)
        for device, out in moves:
            held.pop(device, None)
            carriage = device in ("Transfer", "Removal")
            switched[f"{device}-{'FORWARD' if carriage else 'VALVE'}"] = out
            conditions.append((f"{device}-{_VALVE[out]}", True))
            conditions.append((f"{device}-{_VALVE[not out]}", False))
        steps.append(
            Step(work, switched, tuple(conditions), watchdog_s, pause_s, held=dict(held))
        )
        for device, out in moves:
            held[device] = f"{device}-{_VALVE[out]}"

    def out(*devices: str) -> tuple[_Move, ...]:
        return tuple((device, True) for device in devices)

    def back(*devices: str) -> tuple[_Move, ...]:
        return tuple((device, False) for device in devices)

    step(*out(*CLAMPS[:4]))
    step(*out("Clamp5", "Clamp6", "Pin1", "Pin2"), until=(("Relays-UNCLAMPED", False),))
    step(
        switch={"Inverter-RUN": True},
        until=(("Relays-CLAMPED", True), ("Inverter-AT_SPEED", True)),
    )
    step(*back("Index"))
    step(*out("Table"), until=(("Relays-TABLE_LOCKED", False),), watchdog_s=7.0)
    step(*out("Index"))
    step(
        switch={"Hydraulics-LOAD": True},
        until=(("Hydraulics-PRESSURE", True), ("Relays-TABLE_LOCKED", True)),
    )
    step(*out(*PUNCHES), pause_s=0.6)
    step(*back(*PUNCHES), switch={"Hydraulics-LOAD": False})
    step(*out(*DRILLS), until=(("Hydraulics-PRESSURE", False),), watchdog_s=8.0)
    step(*back(*DRILLS))
    step(*out("Tap1", "Tap2"), watchdog_s=6.0)
    step(*back("Tap1", "Tap2"))
    step(
        *back("Index"),
        switch={"Inverter-RUN": False},
        until=(("Relays-TOOLS_HOME", True), ("Inverter-STANDSTILL", True)),
    )
    step(*back("Table"), watchdog_s=7.0)
    step(*out("Index"))
    step(*back("Pin1", "Pin2"), pause_s=0.4)
    work = False
    step(*back(*CLAMPS), until=(("Relays-PINS_IN", False),))
    step(*back("Guard"), until=(("Relays-UNCLAMPED", True),))
    step(*out("Eject1", "Eject2"))
    step(*out("Removal"))
    step(*out("Grip1"), until=(("Removal-PART_ON", True),))
    step(*back("Eject1", "Eject2"))
    step(*back("Removal"))
    step(*back("Grip1"), switch={"Outfeed-BELT": True}, until=(("Removal-PART_ON", False),))
    step(until=(("Outfeed-EXIT", True),), watchdog_s=8.0)
    step(switch={"Infeed-BELT": True}, until=(("Infeed-WAITING", True),), watchdog_s=None)
    step(*back("Stop1"), until=(("Infeed-AT_STOP", True),), watchdog_s=8.0)
    step(
        *out("Stop1", "Lift1", "Lift2"),
        switch={"Infeed-BELT": False, "Outfeed-BELT": False},
    )
    step(*out("Grip2"), until=(("Transfer-PART_ON", True),))
    step(*out("Transfer"))
    step(*out("Slide1", "Slide2"))
    step(*back("Grip2"), until=(("Transfer-PART_ON", False),))
    step(*back("Transfer"))
    step(*back("Lift1", "Lift2", "Slide1", "Slide2"))
    step(*out("Centre1", "Centre2"))
    step(*back("Centre1", "Centre2"))
    step(*out("Guard"), switch={"OilPump-LUBRICATE": True}, until=(("OilPump-FLOW", True),))
    step(
        switch={"OilPump-LUBRICATE": False},
        until=(("OilPump-FLOW", False), ("Relays-PRESS_FREE", True)),
        pause_s=0.5,
    )
    # The chart is a ring: what its end has reached is held when it begins again.
    first = dict(held)
    ring: list[Step] = []
    for each in steps:
        for output in each.switch:
            first.pop(output.split("-")[0], None)
        ring.append(
            Step(
                each.work,
                each.switch,
                each.until,
                each.watchdog_s,
                each.pause_s,
                held=first | each.held,
            )
        )
    return tuple(ring)


STEPS = _steps()

AT_START = {"Guard-VALVE": True, "Index-VALVE": True, "Stop1-VALVE": True, "Stop2-VALVE": False}
"""Outputs that are ON when the shift begins; the machine stands ready for its first part."""
