"""Bottles ride, wait behind one another, and are seen where they are."""

import pytest

from runglight.plants.agenda import Agenda, nanoseconds
from runglight.plants.bottling.belt import DIAMETER_M, END_M, SPEED_M_PER_S, Belt, Bottle, Eye


class Line:
    """A belt with one stop at half a metre and one eye before it."""

    def __init__(self) -> None:
        self.agenda = Agenda(0)
        self.seen: list[tuple[float, bool]] = []
        self.belt = Belt(self.agenda, {"stop": 0.5}, {"eye": Eye(0.2, 0.3)}, self._hear)

    def _hear(self, name: str, sees: bool) -> None:
        assert name == "eye"
        self.seen.append((round(self.agenda.now_ns / 1e9, 6), sees))

    def at(self, seconds: float) -> list[float]:
        self.agenda.advance(nanoseconds(seconds))
        self.belt.settle()
        return [round(bottle.position_m, 6) for bottle in self.belt.bottles]


def test_a_bottle_rides_past_an_eye_to_a_stop() -> None:
    line = Line()
    line.belt.run(True)
    assert line.belt.place(Bottle())
    assert line.at(1.0) == [SPEED_M_PER_S]
    assert line.at(60.0) == [0.5]
    assert line.seen == [(0.8, True), (1.2, False)]
    assert line.belt.travel_m == pytest.approx(60 * SPEED_M_PER_S)


def test_bottles_wait_behind_one_another_and_one_passes_a_stop_that_opens_briefly() -> None:
    line = Line()
    line.belt.run(True)
    for second in range(3):
        line.at(float(second))
        assert line.belt.place(Bottle())
    assert line.at(20.0) == [0.5, round(0.5 - DIAMETER_M, 6), round(0.5 - 2 * DIAMETER_M, 6)]
    line.belt.close("stop", closed=False)
    line.at(20.1)
    line.belt.close("stop", closed=True)
    assert line.at(21.0) == [0.75, 0.5, round(0.5 - DIAMETER_M, 6)]
    assert len(line.at(40.0)) == 2
    assert END_M > 0.75


def test_nothing_moves_on_a_belt_that_stands() -> None:
    line = Line()
    line.belt.run(True)
    line.belt.place(Bottle())
    line.at(0.4)
    line.belt.run(False)
    assert line.at(30.0) == [0.1]
    line.belt.run(True)
    assert line.at(30.4) == [0.2]
    assert line.seen == [(30.4, True)]


def test_there_is_no_room_where_a_bottle_stands() -> None:
    line = Line()
    assert line.belt.place(Bottle())
    assert not line.belt.place(Bottle())
