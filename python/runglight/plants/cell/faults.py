"""The twelve faults of Ghosh 2016, Table 4."""

from dataclasses import replace

from runglight.plants.cell.symbols import GROUP
from runglight.plants.faults import FaultDescription, FaultKind, Transition


def _state(short_state: str) -> str:
    return f"{GROUP}-{short_state}"


def _transition(text: str) -> Transition:
    before, after = text.split(" > ")
    return _state(before), _state(after)


def _describe(
    number: int,
    name: str,
    sentence: str,
    kind: FaultKind,
    where: str,
    *,
    faulty: str | None = None,
    expected: tuple[str, ...] = (),
    expected_s: float | None = None,
    last_state: str | None = None,
) -> FaultDescription:
    device, signal = where.split("-")
    return FaultDescription(
        number,
        name,
        sentence,
        kind,
        GROUP,
        device,
        signal,
        _transition(faulty) if faulty else None,
        tuple(_transition(transition) for transition in expected),
        expected_s,
        _state(last_state) if last_state else None,
    )


FAULTS: dict[int, FaultDescription] = {
    fault.number: fault
    for fault in (
        _describe(
            1,
            "prt-chk-on-while-returning",
            "The part sensor of the part loader turns on for a moment while the loader returns "
            "home empty.",
            FaultKind.SENSOR_GLITCH,
            "PrtLDR-PRT_CHK",
            faulty="PrtLDR-ADV_OFF > PrtLDR-PRT_CHK_ON",
            expected=("PrtLDR-ADV_OFF > PrtLDR-RET_ON",),
        ),
        _describe(
            2,
            "opsen1-stuck-on",
            "The sensor for the open left clamp sticks at on from the moment robot 1 picks the "
            "part up, whether the clamp is open or not.",
            FaultKind.SENSOR_STUCK_ON,
            "DCLAMP-OpSen1",
            faulty="DCLAMP-CLOSE_ON > DCLAMP-OpSen2_OFF",
            expected=("DCLAMP-CLOSE_ON > DCLAMP-OpSen1_OFF",),
        ),
        _describe(
            3,
            "open-decelerated",
            "The clamps are slow to follow their open command once.",
            FaultKind.ACTUATOR_SLOW,
            "DCLAMP-OPEN",
            faulty="DCLAMP-OPEN_ON > DCLAMP-ClsSen1_OFF",
            expected_s=0.03,
        ),
        _describe(
            4,
            "first-work-comp-off-while-moving",
            "Robot 1's report that it has picked the part up drops out for a moment while it "
            "carries the part.",
            FaultKind.SENSOR_GLITCH,
            "RBT1-1ST_WORK_COMP",
            faulty="RBT1-PRT_MOVE_ON > RBT1-1ST_WORK_COMP_OFF",
            expected=("RBT1-PRT_MOVE_ON > RBT1-2ND_WORK_COMP_ON",),
        ),
        _describe(
            5,
            "forward-dead",
            "The part loader's forward drive dies while a part is being set: the loader never "
            "leaves home and the line stops.",
            FaultKind.ACTUATOR_DEAD,
            "PrtLDR-FORWARD",
            last_state="PrtLDR-FORWARD_ON",
        ),
        _describe(
            6,
            "parts-mostly-60-s",
            "Of every thirty parts, seven come after about 30 s and twenty-three after about "
            "60 s, instead of half and half.",
            FaultKind.PART_PATTERN,
            "PrtLDR-PRT_CHK",
            faulty="PrtLDR-BACKWARD_OFF > PrtLDR-PRT_CHK_ON",
        ),
        _describe(
            7,
            "ret-off-at-home",
            "The part loader's home sensor drops out for a moment while the loader stands at "
            "home, before the first part.",
            FaultKind.SENSOR_GLITCH,
            "PrtLDR-RET",
            faulty="PrtLDR-RET_ON > PrtLDR-RET_OFF",
            expected=(
                "PrtLDR-RET_ON > PrtLDR-BACKWARD_OFF",
                "PrtLDR-RET_ON > PrtLDR-PRT_CHK_ON",
            ),
        ),
        _describe(
            8,
            "home-pos-on-while-placing",
            "Robot 1's home sensor turns on for a moment while the robot places the part on the "
            "Daecha.",
            FaultKind.SENSOR_GLITCH,
            "RBT1-HOME_POS",
            faulty="RBT1-2ND_WORK_COMP_ON > RBT1-HOME_POS_ON",
            expected=("RBT1-2ND_WORK_COMP_ON > RBT1-PRT_MOVE_OFF",),
        ),
        _describe(
            9,
            "backward-decelerated",
            "The part loader is slow to follow its backward command once.",
            FaultKind.ACTUATOR_SLOW,
            "PrtLDR-BACKWARD",
            faulty="PrtLDR-BACKWARD_ON > PrtLDR-ADV_OFF",
            expected_s=0.04,
        ),
        _describe(
            10,
            "clssen1-dead",
            "The sensor for the closed left clamp dies while the part loader advances: the "
            "clamps close, nobody hears of it, and the line stops.",
            FaultKind.SENSOR_DEAD,
            "DCLAMP-ClsSen1",
            faulty="DCLAMP-OpSen2_OFF > DCLAMP-ClsSen2_ON",
            expected=("DCLAMP-OpSen2_OFF > DCLAMP-ClsSen1_ON",),
        ),
        _describe(
            11,
            "prt-pick-dead",
            "Robot 1 stops following its pick command while the Daecha returns: in the next "
            "cycle it never starts and the line stops.",
            FaultKind.ACTUATOR_DEAD,
            "RBT1-PRT_PICK",
            last_state="RBT1-PRT_PICK_ON",
        ),
        _describe(
            12,
            "prt-move-decelerated",
            "Robot 1 carries one part to the Daecha at two thirds of its speed.",
            FaultKind.ACTUATOR_SLOW,
            "RBT1-PRT_MOVE",
            faulty="RBT1-PRT_MOVE_ON > RBT1-2ND_WORK_COMP_ON",
            expected_s=16.01,
        ),
    )
}

FAULTS_AT_WORK: dict[int, FaultDescription] = FAULTS | {
    7: replace(
        FAULTS[7],
        sentence=FAULTS[7].sentence.replace("the first part", "the next part"),
        faulty=_transition("PrtLDR-BACKWARD_OFF > PrtLDR-RET_OFF"),
        expected=(_transition("PrtLDR-BACKWARD_OFF > PrtLDR-PRT_CHK_ON"),),
    )
}
"""The same faults in a cell that already works: there, the loader's way home is behind it."""
