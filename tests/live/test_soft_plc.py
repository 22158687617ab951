"""A whole machine over real Modbus TCP, in virtual time: nothing cried, every fault found."""

import asyncio
import json
from pathlib import Path

import pytest

from runglight.configuration import Symbols
from runglight.live.batch_watcher import BatchWatcher
from runglight.live.keeper import Keeper
from runglight.live.session import Session
from runglight.live.signal_names import model_names
from runglight.model import NominalModel
from runglight.plants.cell.running import RunningCell
from runglight.softplc import SoftPlc, serve
from runglight.taps import open_tap
from runglight.taps.base import ConnectionState
from runglight.taps.virtual_clock import VirtualClock

START_NS = 1_767_592_800_000_000_000
SECOND_NS = 1_000_000_000
GUARD_S = 900


class Run:
    """One session over a served cell; `after` virtual seconds it ends."""

    def __init__(self, model: NominalModel, directory: Path) -> None:
        self._model = model
        self._directory = directory
        self.findings: list[dict[str, object]] = []
        self.said: list[str] = []

    def __call__(self, seconds: int, *acts: tuple[int, str]) -> "Run":
        asyncio.run(asyncio.wait_for(self._watch(seconds, acts), GUARD_S))
        return self

    async def _watch(self, seconds: int, acts: tuple[tuple[int, str], ...]) -> None:
        clock = VirtualClock(START_NS)
        async with serve(RunningCell(START_NS, seed=5), "modbus://127.0.0.1:0", clock) as plc:
            tap = open_tap(plc.tap_url.replace("interval=10ms", "interval=50ms"), clock=clock)
            async with tap:
                session = Session(
                    tap,
                    BatchWatcher(
                        self._model,
                        self._model.monitor(),
                        tap.signals,
                        model_names(self._model, Symbols()),
                    ),
                    Keeper(self._directory, self.said.append),
                    tell=lambda lines: self.findings.extend(map(json.loads, lines)),
                    say=self.said.append,
                )
                with clock.hold():
                    watching = asyncio.create_task(session.run())
                    while tap.connection.state is not ConnectionState.CONNECTED:
                        await asyncio.sleep(0.001)
                    beside = [
                        asyncio.create_task(self._act(clock, plc, acts)),
                        asyncio.create_task(self._end(clock, session, seconds)),
                    ]
                    await asyncio.sleep(0)
                await asyncio.gather(watching, *beside)

    async def _act(
        self, clock: VirtualClock, plc: SoftPlc, acts: tuple[tuple[int, str], ...]
    ) -> None:
        for second, act in acts:
            await clock.sleep_until(START_NS + second * SECOND_NS)
            if act == "kill":
                await plc.stop()
            elif act == "restart":
                await plc.start()
            else:
                plc.inject(act)

    async def _end(self, clock: VirtualClock, session: Session, seconds: int) -> None:
        await clock.sleep_until(START_NS + seconds * SECOND_NS)
        session.stop()

    @property
    def kinds(self) -> set[str]:
        return {str(finding["kind"]) for finding in self.findings}


@pytest.fixture
def run(nominal_model: NominalModel, model_directory: Path) -> Run:
    return Run(nominal_model, model_directory)


def test_a_sound_machine_has_no_alarm(run: Run) -> None:
    run(400)
    assert not [each for each in run.findings if each["severity"] != "notice"]
    assert not run.said


def test_a_fault_is_named_with_its_address(run: Run) -> None:
    run(400, (150, "prt-chk-on-while-returning"))
    fault = next(each for each in run.findings if each["severity"] == "fault")
    assert (fault["device"], fault["address"]) == ("PrtLDR", "%IX0.2")


def test_a_server_that_is_killed_is_a_gap_and_no_fault(run: Run) -> None:
    run(500, (100, "kill"), (160, "restart"), (260, "kill"), (265, "restart"))
    assert run.kinds == {"gap"}
    assert len(run.findings) == 2
    assert sum("connected again" in each for each in run.said) == 2


def test_a_dead_drive_is_a_stall_by_the_clock(run: Run) -> None:
    run(600, (100, "forward-dead"))
    assert "stall" in run.kinds
