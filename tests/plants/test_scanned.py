"""A running plant of words, bits and a memory that shows: a tank that is filled and emptied."""

from collections.abc import Sequence

from runglight.plants import Image, Symbol
from runglight.plants.scanned import ScannedPlant

SCAN_NS = 10_000_000
LITRE_NS = 25_000_000
"""The tank fills and empties by one litre in this time."""
FULL = 7

SYMBOLS = (
    Symbol("%MW0", "Tank", "Program", "STEP", "memory", "1 fills, 2 empties", "UINT"),
    Symbol("%QX0.0", "Tank", "Valve", "FILL", "output", "fill the tank"),
    Symbol("%IW0", "Tank", "Level", "LITRES", "input", "what is in the tank", "UINT"),
    Symbol("%IX0.0", "Tank", "Level", "EMPTY", "input", "the tank is empty"),
)


class Tank:
    """Changes by a litre whenever one has flowed."""

    def __init__(self, start_ns: int) -> None:
        self.litres = 0
        self._filling = False
        self._next_ns: int | None = None
        self._now_ns = start_ns

    def advance(self, now_ns: int) -> None:
        while self._next_ns is not None and self._next_ns <= now_ns:
            self.litres += 1 if self._filling else -1
            more = self.litres < FULL if self._filling else self.litres > 0
            self._next_ns = self._next_ns + LITRE_NS if more else None
        self._now_ns = now_ns

    def read_inputs(self) -> tuple[int, ...]:
        return self.litres, self.litres == 0

    def write_outputs(self, outputs: Sequence[int]) -> None:
        self._filling = bool(outputs[0])
        self._next_ns = self._now_ns + LITRE_NS

    def next_event_ns(self) -> int | None:
        return self._next_ns


class Program:
    """Fills until full, empties until empty."""

    def __init__(self) -> None:
        self.step = 0
        self.settled = False

    def scan(self, inputs: Sequence[int], now_ns: int) -> tuple[int, ...]:
        litres, empty = inputs
        before = self.step
        if empty:
            self.step = 1
        elif litres == FULL:
            self.step = 2
        self.settled = self.step == before
        return (int(self.step == 1),)

    def next_timer_ns(self) -> int | None:
        return None


def running(start_ns: int = 0) -> tuple[ScannedPlant[int], list[tuple[int, str, int]]]:
    program, rows = Program(), []
    plant = ScannedPlant(
        SYMBOLS,
        Tank(start_ns),
        program,
        start_ns=start_ns,
        outputs=(0,),
        memory=lambda: (program.step,),
    )
    plant.on_change(lambda time_ns, row, value: rows.append((time_ns, SYMBOLS[row].signal, value)))
    return plant, rows


def test_words_and_memory_change_scan_by_scan() -> None:
    plant, rows = running()
    plant.advance(0)
    assert plant.image() == Image((0, 1), (0,), (0,))
    plant.advance(SCAN_NS)
    assert plant.image() == Image((0, 1), (1,), (1,))
    plant.advance(10 * SCAN_NS)
    assert rows == [
        (0, "EMPTY", 1),
        # output and memory are seen in the scan after the one that set them
        (SCAN_NS, "FILL", 1),
        (SCAN_NS, "STEP", 1),
        # a litre has flowed 25 ms later, and again
        (3 * SCAN_NS, "LITRES", 1),
        (3 * SCAN_NS, "EMPTY", 0),
        (5 * SCAN_NS, "LITRES", 2),
        (8 * SCAN_NS, "LITRES", 3),
        (10 * SCAN_NS, "LITRES", 4),
    ]


def test_it_works_without_an_end_however_it_is_advanced() -> None:
    plant, rows = running(start_ns=5)
    fine, fine_rows = running(start_ns=5)
    plant.advance(100 * 1_000_000_000)
    for now_ns in range(0, 100 * 1_000_000_000, 7_000_000):
        fine.advance(now_ns)
    fine.advance(100 * 1_000_000_000)
    assert rows == fine_rows
    assert len(rows) > 1000
    assert max(value for _, signal, value in rows if signal == "LITRES") == FULL
    assert {time_ns % SCAN_NS for time_ns, _, _ in rows} == {5}
