"""A soft PLC in virtual and in real time."""

import asyncio
import re
from pathlib import Path

import pytest
from pymodbus.client import AsyncModbusTcpClient

from runglight.plants.cell import RunningCell, simulate_cell
from runglight.softplc import PlcChange, serve
from runglight.taps.clock import SteadyClock
from runglight.taps.virtual_clock import VirtualClock

S = 1_000_000_000
START_NS = 1_767_592_800 * S
SCAN_NS = 10_000_000


def test_polled_in_virtual_time_it_shows_every_change_of_the_simulated_run() -> None:
    """Two minutes at 10 ms, over a real socket, without a scan missed or seen twice."""
    run = simulate_cell(seed=3)
    until_ns = START_NS + 120 * S
    expected = [
        PlcChange(time_ns, run.signals[number], value)
        for time_ns, number, value in zip(
            run.time_ns.tolist(), run.signal_index.tolist(), run.value.tolist(), strict=True
        )
        if time_ns <= until_ns
    ]

    async def poll() -> tuple[list[PlcChange], list[PlcChange]]:
        clock = VirtualClock(START_NS)
        cell = RunningCell(START_NS, seed=3)
        names = {
            name: [symbol.name for symbol in cell.symbols if symbol.signal_class == name]
            for name in ("input", "output")
        }
        seen: list[PlcChange] = []
        async with serve(cell, "modbus://127.0.0.1:0", clock, keep_changes=True) as plc:
            client = AsyncModbusTcpClient("127.0.0.1", port=plc.url.port, timeout=10, retries=0)
            await client.connect()
            last: dict[str, int] = dict.fromkeys((*names["input"], *names["output"]), 0)
            for scan in range((until_ns - START_NS) // SCAN_NS + 1):
                await clock.sleep_until(START_NS + scan * SCAN_NS)
                inputs = (await client.read_discrete_inputs(0, count=16)).bits
                outputs = (await client.read_coils(0, count=13)).bits
                for name, value in (
                    *zip(names["input"], inputs, strict=False),
                    *zip(names["output"], outputs, strict=False),
                ):
                    if last[name] != value:
                        last[name] = value
                        seen.append(PlcChange(clock.now_ns(), name, int(value)))
            client.close()
            return seen, plc.changes

    seen, changes = asyncio.run(asyncio.wait_for(poll(), 900))
    assert len(expected) > 50
    assert seen == expected
    assert changes == expected


@pytest.mark.parametrize("keep", [True, False])
def test_changes_are_kept_on_request_only(keep: bool) -> None:
    async def work() -> None:
        clock = VirtualClock(START_NS)
        cell = RunningCell(START_NS)
        async with serve(cell, "s7://127.0.0.1:0", clock, keep_changes=keep) as plc:
            clock.advance_to(START_NS + 3600 * S)
            changes = plc.changes
            assert len(changes) == (plc.change_count if keep else 0)
            assert plc.change_count > 1000
            assert sorted(changes, key=lambda change: change.time_ns) == changes

    asyncio.run(work())


def test_in_real_time_the_plant_works_although_nobody_reads() -> None:
    async def work() -> None:
        clock = SteadyClock()
        cell = RunningCell(clock.now_ns())
        before_ns = cell.now_ns
        async with serve(cell, "modbus://127.0.0.1:0", clock) as plc:
            assert sum(cell.image().inputs) == 6
            assert plc.change_count == 6
            async with asyncio.timeout(60):
                while cell.now_ns < before_ns + S // 5:
                    await asyncio.sleep(0.01)

    asyncio.run(work())


def test_faults_are_switched_on_while_it_serves() -> None:
    async def work() -> None:
        clock = VirtualClock(START_NS)
        async with serve(RunningCell(START_NS), "s7://127.0.0.1:0", clock) as plc:
            clock.advance_to(START_NS + 3600 * S)
            plc.inject("forward-dead")
            assert plc.labels() == ()
            clock.advance_to(START_NS + 3900 * S)
            (label,) = plc.labels()
            assert START_NS + 3600 * S < label.time_ns < START_NS + 3800 * S
            stopped = plc.change_count
            clock.advance_to(START_NS + 7200 * S)
            plc.look()
            assert plc.change_count == stopped

    asyncio.run(work())


def test_the_guide_s_example_runs(capsys: pytest.CaptureFixture[str]) -> None:
    guide = Path(__file__).parents[2] / "docs" / "guides" / "soft-plc.md"
    (example,) = re.findall(r"```python\n(.*?)```", guide.read_text(encoding="utf-8"), re.DOTALL)
    exec(compile(example, str(guide), "exec"), {})
    assert "inputs=0-15&coils=0-12&names=openplc" in capsys.readouterr().out
