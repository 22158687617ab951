"""The two PLC programs of Theis 2019, section VI-B (figures 2 and 3)."""

from runglight.plants.tank.ladder import Coil, Contact, CountUp, Ladder, Parallel, Series

INPUTS = ("ul", "ll", "ml")
OUTPUTS = ("inv", "outv")
COUNTER_PRESET = 3

_VALVES = (
    Coil(Contact("ctrl"), "inv"),
    Coil(Contact("ctrl"), "outv", negated=True),
)

C1 = Ladder(
    "c1",
    INPUTS,
    OUTPUTS,
    (
        Coil(
            Series(
                (
                    Parallel((Contact("ll", negated=True), Contact("ctrl"))),
                    Contact("ul", negated=True),
                )
            ),
            "ctrl",
        ),
        *_VALVES,
    ),
)
"""Fills up to the upper sensor, then empties below the lower one."""

C2 = Ladder(
    "c2",
    INPUTS,
    OUTPUTS,
    (
        CountUp(Contact("ul"), Contact("ll", negated=True), COUNTER_PRESET, "cnt"),
        Coil(Contact("cnt"), "pass"),
        Coil(
            Series(
                (
                    Parallel(
                        (
                            Contact("ll", negated=True),
                            Series((Contact("ml", negated=True), Contact("pass", negated=True))),
                            Contact("ctrl"),
                        )
                    ),
                    Contact("ul", negated=True),
                )
            ),
            "ctrl",
        ),
        *_VALVES,
    ),
)
"""Swings between the upper and the middle sensor; full for the third time, it empties the tank."""

PROGRAMS = {program.name: program for program in (C1, C2)}
