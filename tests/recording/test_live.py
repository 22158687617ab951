"""A real tap on a real server, recorded: what is lost is a gap, and nothing else."""

import asyncio
from collections.abc import Callable
from pathlib import Path

import numpy as np

from runglight.recording.meter import Meter
from runglight.recording.read import open_recording
from runglight.recording.recorder import Recorder
from runglight.recording.run import record
from runglight.taps import open_tap
from runglight.taps.base import ConnectionState, Gap
from tests.taps.benches.modbus import ModbusBench

HANGS_S = 60


async def reached(true: Callable[[], bool]) -> None:
    async with asyncio.timeout(HANGS_S):
        while not true():
            await asyncio.sleep(0.01)


def test_a_server_that_goes_away_and_comes_back(tmp_path: Path) -> None:
    async def run() -> None:
        bench = ModbusBench()
        await bench.start()
        try:
            async with open_tap(bench.url, interval="5ms") as tap:
                with Recorder(tmp_path, tap, reserve_bytes=0) as recorder:
                    running = asyncio.create_task(record(tap, recorder, meter=Meter(5_000_000)))
                    await reached(lambda: recorder.scans > 10)
                    image = recorder.rows
                    await bench.change(1)
                    await reached(lambda: recorder.rows > image)
                    await bench.kill()
                    await reached(lambda: tap.connection.state is ConnectionState.RETRYING)
                    before = recorder.scans
                    await bench.start()
                    await reached(lambda: recorder.scans > before + 10)
                    running.cancel()
                    await asyncio.gather(running, return_exceptions=True)
        finally:
            await bench.kill()

    asyncio.run(run())
    recording = open_recording(tmp_path)
    [gap] = recording.marks
    assert isinstance(gap, Gap)
    assert gap.reason
    scans = recording.scan_ns
    assert np.all(np.diff(scans) > 0)
    assert not np.any((scans > gap.start_ns) & (scans < gap.end_ns))
    time_ns, _, _ = recording.log.columns()
    assert recording.log.engine.gaps == [(gap.start_ns, gap.end_ns)]
    signals = len(recording.description.signals)
    # All signals at the start and after the gap, and the one change.
    assert len(recording.log) == 2 * signals + 1
    assert np.count_nonzero(time_ns >= gap.end_ns) == signals
