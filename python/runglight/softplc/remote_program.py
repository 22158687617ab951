"""A PLC program at work on a plant that is served elsewhere: read, solve, write, once per scan."""

from collections.abc import Sequence
from typing import Protocol

from runglight.control.link import Image, PlantLink
from runglight.control.loop import ScanLoop, Writes
from runglight.control.terminals import Terminals
from runglight.plants.symbols import Symbol
from runglight.taps.clock import Clock
from runglight.taps.grid import Grid


class Program(Protocol):
    """A PLC program over bits."""

    def scan(self, inputs: Sequence[bool], now_ns: int) -> tuple[bool, ...]:
        """Runs the program once."""


class _AtWork:
    def __init__(self, program: Program, inputs: int, outputs: int) -> None:
        self._program = program
        self._inputs = inputs
        self._outputs = range(inputs, inputs + outputs)

    def step(self, now_ns: int, image: Image) -> Writes:
        solved = self._program.scan([bool(value) for value in image[: self._inputs]], now_ns)
        return [
            (terminal, int(value))
            for terminal, value in zip(self._outputs, solved, strict=True)
            if image[terminal] != int(value)
        ]

    def lost(self, now_ns: int, reason: str) -> None:
        """A PLC keeps scanning; this one has nothing to scan."""

    def farewell(self) -> Writes:
        """A PLC that stops switches its outputs off."""
        return [(terminal, 0) for terminal in self._outputs]


def remote_program(
    program: Program, symbols: Sequence[Symbol], url: str, *, clock: Clock, grid: Grid
) -> ScanLoop:
    """The loop that runs `program` on the plant at `url` (`modbus://HOST:PORT`).

    `symbols` are the program's inputs and then its outputs.
    """
    rows = [(symbol.address, symbol.signal_class) for symbol in symbols]
    inputs = sum(symbol.signal_class == "input" for symbol in symbols)
    at_work = _AtWork(program, inputs, len(symbols) - inputs)
    return ScanLoop(PlantLink(url, Terminals.of(rows)), clock, grid, at_work)
