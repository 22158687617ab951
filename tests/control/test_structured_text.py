"""Structured Text: parsed by another parser, and executed against the tank."""

import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from runglight._engine import PetriNet, structured_text_of
from runglight.control.guards import learn_guards
from runglight.log.changelog import Log, read_log
from runglight.plants.tank import SYMBOLS, simulate_tank
from runglight.plants.tank.flows import P1, P2, Flows
from runglight.plants.tank.ladder import LadderProgram
from runglight.plants.tank.plant import TankPlant
from runglight.plants.tank.programs import C1, C2
from tests.control.nets import FIGURE_5, FIGURE_7, net
from tests.control.structured_text import StructuredText

SCAN_NS = 100_000_000
INPUTS = [symbol.address for symbol in SYMBOLS if symbol.signal_class == "input"]
TIMED = [
    ("%IX0.0=1", "p0", "p1"),
    ("%QX0.0=1", "p1", "p2"),
    ("%IX0.0=0", "p2", "p3"),
    ("%QX0.0=0", "p3", "p4"),
]


def _log(scenario: str) -> Log:
    run = simulate_tank(scenario)
    return Log.from_columns(run.time_ns, run.signal_index, run.value, run.signals)


def _text(net_: PetriNet, scenario: str) -> str:
    guards = learn_guards(net_, [_log(scenario)]).text
    return structured_text_of(net_, guards, [("%QX0.1", 1)], "tank")


def _executed(text: str, flows: Flows, scans: int) -> tuple[list[tuple[bool, ...]], float, float]:
    program = StructuredText(text)
    tank = TankPlant(0, 1, flows)
    told: list[tuple[bool, ...]] = []
    for scan in range(scans):
        tank.advance(scan * SCAN_NS)
        inputs = dict(zip(INPUTS, tank.read_inputs(), strict=True))
        outputs = program.scan(inputs, scan * 100)
        told.append((bool(outputs["%QX0.0"]), bool(outputs["%QX0.1"])))
        tank.write_outputs(told[-1])
        assert not program.variables["alarm"], f"scan {scan}: state {program.variables['state']}"
    return told, tank.lowest, tank.highest


def _original(program: LadderProgram, flows: Flows, scans: int) -> list[tuple[bool, ...]]:
    tank = TankPlant(0, 1, flows)
    told = []
    for scan in range(scans):
        tank.advance(scan * SCAN_NS)
        told.append(program.scan(tank.read_inputs(), scan * SCAN_NS))
        tank.write_outputs(told[-1])
    return told


def test_executed_at_the_tank_it_does_what_the_programs_do_for_an_hour(tmp_path: Path) -> None:
    for arcs, last, scenario, ladder, flows in (
        (FIGURE_5, "p8", "1", C1, P1),
        (FIGURE_7, "p9", "2", C2, P1),
        (FIGURE_7, "p9", "3", C2, P2),
    ):
        text = _text(net(tmp_path, arcs, last), scenario)
        told, lowest, highest = _executed(text, flows, 36_000)
        assert told == _original(LadderProgram(ladder), flows, 36_000)
        assert lowest >= 0
        assert highest < 95


def test_what_the_net_does_not_allow_leads_to_the_safe_state(tmp_path: Path) -> None:
    program = StructuredText(_text(net(tmp_path, FIGURE_5, "p8"), "1"))
    assert program.scan(dict.fromkeys(INPUTS, False), 0) == {"%QX0.0": True, "%QX0.1": False}
    wrong = dict(zip(INPUTS, (False, False, True), strict=True))
    assert program.scan(wrong, 100) == {"%QX0.0": False, "%QX0.1": True}
    assert program.variables["alarm"]
    # It holds it.
    assert program.scan(dict.fromkeys(INPUTS, False), 200) == {"%QX0.0": False, "%QX0.1": True}


def test_a_sensor_that_never_comes_leads_to_the_safe_state(tmp_path: Path) -> None:
    program = StructuredText(_text(net(tmp_path, FIGURE_5, "p8"), "1"))
    inputs = dict.fromkeys(INPUTS, False)
    for tenth in range(30):
        program.scan(inputs, tenth * 100)
    assert program.variables["alarm"]


def test_a_timer_is_a_ton(tmp_path: Path) -> None:
    rows = ["time,signal,value", "0,%IX0.0,0", "0,%QX0.0,0"]
    for cycle in range(10):
        at = 10 * cycle
        rows += [
            f"{at + 1},%IX0.0,1",
            f"{at + 3},%QX0.0,1",
            f"{at + 5},%IX0.0,0",
            f"{at + 5.1},%QX0.0,0",
        ]
    path = tmp_path / "timed.csv"
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    timed = net(tmp_path, TIMED, "p4")
    text = structured_text_of(timed, learn_guards(timed, [read_log(path)]).text)
    program = StructuredText(text)
    on = [program.scan({"%IX0.0": tenth >= 5}, tenth * 100)["%QX0.0"] for tenth in range(0, 40)]
    assert on.index(True) == 25


@pytest.mark.skipif(find_spec("blark") is None, reason="blark (GPL) is an oracle, no dependency")
def test_another_parser_reads_it(tmp_path: Path) -> None:
    # A program of its own: nothing of it is imported here.
    blark = Path(sys.executable).with_name("blark")
    assert blark.exists() or shutil.which("blark")
    for arcs, last, scenario in ((FIGURE_5, "p8", "1"), (FIGURE_7, "p9", "2")):
        path = tmp_path / f"{last}.st"
        path.write_text(_text(net(tmp_path, arcs, last), scenario), encoding="utf-8")
        parsed = _blark(blark, path)
        assert parsed.returncode == 0, parsed.stdout + parsed.stderr
        # A parser that takes everything would prove nothing.
        path.write_text(path.read_text(encoding="utf-8").replace("THEN", "", 1), encoding="utf-8")
        assert _blark(blark, path).returncode != 0


def _blark(blark: Path, path: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [str(blark), "parse", str(path)], capture_output=True, text=True, timeout=120, check=False
    )
