"""Six hours of a machine through live watch: `python -m benches.six_hours [--hours 6]`.

The simulated cell is served over real Modbus TCP and polled by the real tap; its time jumps from
scan to scan. First the sound cell: memory at every hour, and what was cried for nothing. Then each
of its twelve faults, put into the running cell after a while: when it was told.
"""

import argparse
import asyncio
import json
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from runglight.configuration import Symbols
from runglight.live.batch_watcher import BatchWatcher
from runglight.live.keeper import Keeper
from runglight.live.session import Session
from runglight.live.signal_names import model_names
from runglight.model import NominalModel, learn
from runglight.plants import symbols_csv
from runglight.plants.cell.faults import FAULTS
from runglight.plants.cell.running import RunningCell
from runglight.plants.cell.simulate import START_NS
from runglight.recording.read import read_recording
from runglight.recording.recorder import Recorder
from runglight.softplc import serve
from runglight.taps import open_tap
from runglight.taps.virtual_clock import VirtualClock

HOUR_S = 3600
SECOND_NS = 1_000_000_000
LEARNED_CYCLES = 40
SOUND_S = 300
"""Watched before a fault is put in."""
FOUND_WITHIN_S = 2 * HOUR_S
PAGE_BYTES = 4096


@dataclass
class Run:
    """What one watch told."""

    lines: list[str] = field(default_factory=list)
    memory_mb: list[float] = field(default_factory=list)
    scans: int = 0

    @property
    def alarms(self) -> list[dict[str, Any]]:
        """Findings that are no notices, each once."""
        first: dict[str, dict[str, Any]] = {}
        for finding in map(json.loads, self.lines):
            if finding["severity"] != "notice":
                first.setdefault(finding["id"], finding)
        return list(first.values())


async def record(directory: Path, interval: str) -> NominalModel:
    """A model of the sound cell, learned from a recording through the tap."""
    clock = VirtualClock(START_NS)
    plant = RunningCell(START_NS, seed=1)
    async with (
        serve(plant, "modbus://127.0.0.1:0", clock) as plc,
        open_tap(_url(plc.tap_url, interval), clock=clock) as tap,
    ):
        symbols = directory / "symbols.csv"
        symbols.write_text(symbols_csv(plc.symbols), encoding="utf-8")
        with Recorder(directory / "nominal", tap) as recorder:
            async for batch in tap:
                recorder.append(batch)
                if plant.cycles > LEARNED_CYCLES:
                    break
    return learn(read_recording(directory / "nominal"), symbols=symbols)


async def watch(
    model: NominalModel,
    directory: Path,
    interval: str,
    *,
    seconds: float,
    seed: int,
    fault: int | None = None,
) -> Run:
    """Watches a cell; with a fault, until the first alarm after it began."""
    clock = VirtualClock(START_NS)
    run = Run()
    async with (
        serve(RunningCell(START_NS, seed=seed), "modbus://127.0.0.1:0", clock) as plc,
        open_tap(_url(plc.tap_url, interval), clock=clock) as tap,
    ):
        names = model_names(model, Symbols())
        session = Session(
            tap,
            BatchWatcher(model, model.monitor(), tap.signals, names),
            Keeper(directory, print),
            tell=run.lines.extend,
            say=print,
        )
        if fault is not None:
            plc.inject(fault, START_NS + SOUND_S * SECOND_NS)

        def hear(now_ns: int) -> None:
            passed_s = (now_ns - START_NS) / SECOND_NS
            if passed_s >= HOUR_S * (len(run.memory_mb) + 1):
                run.memory_mb.append(_memory_mb())
            if passed_s >= seconds or (fault is not None and run.lines and run.alarms):
                session.stop()

        clock.on_advance(hear)
        await session.run()
        run.scans = session.status().scans
    return run


def _url(tap_url: str, interval: str) -> str:
    return tap_url.replace("interval=10ms", f"interval={interval}")


def _memory_mb() -> float:
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * PAGE_BYTES / 1e6


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--hours", type=float, default=6.0)
    parser.add_argument("--interval", default="10ms")
    parser.add_argument("--faults", type=int, nargs="*", default=list(FAULTS), help="numbers")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        directory = Path(name)
        model = asyncio.run(record(directory, asked.interval))
        model.save(directory / "cell.model")
        began_s = time.monotonic()
        sound = asyncio.run(
            watch(model, directory / "cell.model", asked.interval,
                  seconds=asked.hours * HOUR_S, seed=2)
        )  # fmt: skip
        memory = ", ".join(f"{each:.1f}" for each in sound.memory_mb)
        print(
            f"sound cell, {asked.hours:g} h polled every {asked.interval} in "
            f"{time.monotonic() - began_s:.0f} s, {sound.scans:,} scans: "
            f"{len(sound.alarms)} alarms, {len(sound.lines)} findings; "
            f"memory by the hour {memory} MB"
        )
        for finding in map(json.loads, sound.lines):
            print("  ", finding["severity"], finding["message"])
        for number in asked.faults:
            fault = FAULTS[number]
            broken = asyncio.run(
                watch(model, directory / "cell.model", asked.interval,
                      seconds=FOUND_WITHIN_S, seed=10 + number, fault=number)
            )  # fmt: skip
            told = broken.alarms[0]["message"] if broken.alarms else "NOT FOUND"
            print(f"fault {number:2} {fault.device}: {told}", flush=True)


if __name__ == "__main__":
    main()
