"""The bottling machine over Modbus TCP with a camera before it: photos and scans fit in time."""

import asyncio
import json
import subprocess
import sys
from pathlib import Path

import numpy as np

from runglight.plants.agenda import NS_PER_S
from runglight.plants.bottling import RunningBottling
from runglight.plants.bottling.simulate import START_NS
from runglight.plants.photo_folder import PhotoFolder
from runglight.recording.cameras import camera_of
from runglight.recording.meter import Meter
from runglight.recording.photos import photos
from runglight.recording.read import open_recording
from runglight.recording.recorder import Recorder
from runglight.recording.run import record
from runglight.softplc import serve
from runglight.softplc.photographer import keep_photographing
from runglight.taps import open_tap
from runglight.taps.virtual_clock import VirtualClock
from tests.conftest import Command

SECONDS = 15


async def photographed(folder: Path, directory: Path, seed: int) -> None:
    """Records the machine for a while, from its tenth second on; simulated time."""
    clock = VirtualClock(START_NS)
    plant = RunningBottling(START_NS, seed)
    async with serve(plant, "modbus://127.0.0.1:0", clock) as plc:
        clock.advance_to(START_NS + 10 * NS_PER_S)
        url = plc.tap_url.replace("10ms", "1s&timeout=60s")
        async with open_tap(url, clock=clock) as tap:
            photo_folder = PhotoFolder(folder)
            camera = camera_of(str(folder), directory, clock)
            with Recorder(directory, tap, reserve_bytes=0) as recorder:
                photographing = asyncio.create_task(
                    keep_photographing(plc, photo_folder, clock, NS_PER_S)
                )
                await record(tap, recorder, meter=Meter(NS_PER_S), camera=camera, for_s=SECONDS)
                photographing.cancel()


def test_every_photo_shows_the_machine_at_the_time_of_its_scan(tmp_path: Path) -> None:
    asyncio.run(photographed(tmp_path / "camera", tmp_path / "recording", seed=2))
    recording = open_recording(tmp_path / "recording")
    kept = photos(tmp_path / "recording")
    scan_ns = recording.scan_ns.tolist()
    assert len(scan_ns) == SECONDS + 1
    assert {photo.time_ns for photo in kept} <= set(scan_ns)
    assert len(kept) >= SECONDS
    again = RunningBottling(START_NS, seed=2)
    for photo in kept[::5]:
        again.advance(photo.time_ns)
        assert photo.path.read_bytes() == again.expose()().content
    time_ns, signal, value = recording.log.columns()
    assert np.unique(time_ns).tolist() == scan_ns
    image = signal[time_ns == scan_ns[0]]
    assert [recording.log.signals[at] for at in image[:2]] == ["%M0", "%M1"]
    assert len(image) == 400
    # What the last scan says is what the machine's memory was.
    again.advance(scan_ns[-1])
    last = {recording.log.signals[at]: int(v) for at, v in zip(signal, value, strict=True)}
    names = [f"%M{n}" for n in range(100)] + [f"%MW{n}" for n in range(300)]
    assert [last[name] for name in names] == [int(v) for v in again.image().memory]


def test_the_commands_in_real_time(runglight: Command, tmp_path: Path) -> None:
    """As a user has it: one command serves and takes photos, beside it another records."""

    serving = [sys.executable, "-u", "-m", "runglight", "simulate", "bottling"]
    serving += [
        "--serve",
        "modbus://127.0.0.1:0",
        "--photos",
        "camera",
        "--photo-interval",
        "500ms",
    ]
    with subprocess.Popen(serving, cwd=tmp_path, stdout=subprocess.PIPE, encoding="utf-8") as plc:
        try:
            assert plc.stdout is not None
            told = [plc.stdout.readline(), plc.stdout.readline()]
            url = told[1].split("tap it with: ")[1].strip()
            assert url.endswith("coils=0-99&holding=0-299&names=iec&interval=10ms")
            recorded = runglight(
                *("record", url, "--interval", "1s", "--to", "recording"),
                *("--camera", "camera", "--for", "3s"),
            )
            assert recorded.returncode == 0, recorded.stderr
        finally:
            plc.terminate()
            plc.wait(60)
    kept = photos(tmp_path / "recording")
    assert kept
    recording = open_recording(tmp_path / "recording")
    first_ns, last_ns = int(recording.scan_ns[0]), recording.until_ns
    assert all(first_ns - NS_PER_S < photo.time_ns < last_ns + NS_PER_S for photo in kept)
    description = json.loads((tmp_path / "recording" / "recording.json").read_text())
    assert len(description["signals"]) == 400
