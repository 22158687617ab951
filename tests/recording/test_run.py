import asyncio
from pathlib import Path

import pytest

from runglight.errors import InputError
from runglight.recording.image_folder import ImageFolder
from runglight.recording.meter import Meter
from runglight.recording.photos import photos
from runglight.recording.read import open_recording, read_recording
from runglight.recording.recorder import Recorder
from runglight.recording.run import record
from runglight.taps.base import Connection, ConnectionState, Gap
from tests.recording.doubles import DoubleTap, at, batch

BATCHES = [batch(n, [(n - 0.5, 0, n)], [n - 0.5, n]) for n in range(1, 301)]


def recorded(tap: DoubleTap, directory: Path, for_s: float | None = None) -> list[int]:
    """The values that were recorded."""
    asyncio.run(_record(tap, directory, for_s))
    value: list[int] = read_recording(directory).columns()[2].tolist()
    return value


async def _record(tap: DoubleTap, directory: Path, for_s: float | None) -> None:
    async with asyncio.timeout(60), tap:
        with Recorder(directory, tap, reserve_bytes=0) as recorder:
            await record(tap, recorder, meter=Meter(tap.interval_ns), for_s=for_s)


def test_to_the_end_of_the_tap(tmp_path: Path) -> None:
    assert recorded(DoubleTap(BATCHES), tmp_path) == list(range(1, 301))


def test_for_some_of_the_taps_time(tmp_path: Path) -> None:
    assert recorded(DoubleTap(BATCHES, ends=False), tmp_path, for_s=99.5) == list(range(1, 101))


def test_for_some_time_without_a_connection(tmp_path: Path) -> None:
    class AwayTap(DoubleTap):
        def __setattr__(self, name: str, value: object) -> None:
            if name == "connection":
                value = Connection(ConnectionState.RETRYING, reason="no route to host")
            super().__setattr__(name, value)

    assert recorded(AwayTap([], ends=False), tmp_path, for_s=0.01) == []


def test_a_lost_connection_is_a_gap(tmp_path: Path) -> None:
    gap = Gap(at(1), at(5), "connection refused")
    tap = DoubleTap([BATCHES[0], batch(6, [(5, 0, 1)], [5, 6], [gap], image=True)])
    recorded(tap, tmp_path)
    recording = open_recording(tmp_path)
    assert recording.marks == (gap,)
    assert recording.log.engine.gaps == [(at(1), at(5))]


def test_cancelled_it_keeps_everything(tmp_path: Path) -> None:
    async def run() -> None:
        tap = DoubleTap(BATCHES, ends=False)
        ticks = asyncio.Event()
        (tmp_path / "camera").mkdir()
        with Recorder(tmp_path / "recording", tap, reserve_bytes=0) as recorder:
            camera = ImageFolder(tmp_path / "camera", tmp_path / "recording")
            running = asyncio.create_task(
                record(tap, recorder, meter=Meter(0), camera=camera, tick=ticks.set)
            )
            await asyncio.wait_for(ticks.wait(), 60)
            (tmp_path / "camera" / "last.jpg").write_bytes(b"x")
            running.cancel()
            with pytest.raises(asyncio.CancelledError):
                await running

    asyncio.run(run())
    assert len(read_recording(tmp_path / "recording")) == 300
    assert len(photos(tmp_path / "recording")) == 1


def test_a_recorder_that_had_to_stop_ends_it_though_nothing_comes(tmp_path: Path) -> None:
    async def run() -> None:
        tap = DoubleTap([], ends=False)
        with Recorder(tmp_path, tap, reserve_bytes=0) as recorder:
            recorder._reserve_bytes = 1 << 62  # The disk fills up.
            async with asyncio.timeout(60):
                await record(tap, recorder, meter=Meter(0))

    with pytest.raises(InputError, match="recording stopped, because only"):
        asyncio.run(run())
