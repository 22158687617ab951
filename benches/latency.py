"""From the change in a PLC to its finding printed: `python -m benches.latency [--seconds 60]`.

A PLC of its own process blinks two lamps in a known order, served over Modbus TCP, and now and
then out of order, at times that fit no grid. `runglight watch` polls it every 10 ms in a second
process, and prints to a pipe; what is read from that pipe is stamped here. The clock is one: all
three run on this computer.
"""

import argparse
import asyncio
import json
import random
import subprocess
import sys
import tempfile
import threading
import time
from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TextIO

import numpy as np

from runglight.log.changelog import Log
from runglight.model import learn
from runglight.plants.faults import FaultDescription, FaultLabel
from runglight.plants.running import Image
from runglight.plants.symbols import Symbol
from runglight.softplc import serve
from runglight.taps.clock import SteadyClock

POLL_S = 0.01
NAMES = ("Line-Lamp-A", "Line-Lamp-B")
NOMINAL = ((0, 1), (1, 1), (0, 0), (1, 0))
# B falls and rises again before A falls: B's fall is what nobody learned.
FAULTY = ((0, 1), (1, 1), (1, 0), (1, 1), (0, 0), (1, 0))
STRANGE_STEP = 2
PAUSE_S = (0.03, 0.06)
AIM_P99_MS = 25.0


class Lamps:
    """Two lamps as a running plant."""

    symbols = (
        Symbol("%IX0.0", "Line", "Lamp", "A", "input", "lamp A"),
        Symbol("%IX0.1", "Line", "Lamp", "B", "input", "lamp B"),
    )
    faults: Mapping[int, FaultDescription] = {}
    cycles = 0

    def __init__(self, start_ns: int, seed: int) -> None:
        self.strange_ns: list[int] = []
        self._values = [0, 0]
        self._listeners: list[Callable[[int, int, int], None]] = []
        self._steps = self._schedule(start_ns, random.Random(seed))
        self._next = next(self._steps)

    def advance(self, now_ns: int) -> None:
        """Switches what is due."""
        while self._next[0] <= now_ns:
            time_ns, lamp, value, strange = self._next
            self._values[lamp] = value
            if strange:
                self.strange_ns.append(time_ns)
            for listener in self._listeners:
                listener(time_ns, lamp, value)
            self._next = next(self._steps)

    def image(self) -> Image:
        """Both lamps."""
        return Image(inputs=tuple(self._values))

    def on_change(self, listener: Callable[[int, int, int], None]) -> None:
        """Who hears of changes."""
        self._listeners.append(listener)

    def inject(self, fault: int | str, at_ns: int | None = None) -> FaultDescription:
        """It breaks by itself."""
        raise ValueError(f"no fault {fault} at {at_ns}")

    def labels(self) -> tuple[FaultLabel, ...]:
        """None: `strange_ns` is the truth."""
        return ()

    def acting(self) -> tuple[FaultDescription, ...]:
        """None: it breaks by itself."""
        return ()

    waiting = acting

    def _schedule(
        self, start_ns: int, chance: random.Random
    ) -> Iterator[tuple[int, int, int, bool]]:
        time_ns, cycle = start_ns, 0
        while True:
            faulty = cycle > 5 and cycle % 2 == 0
            for step, (lamp, value) in enumerate(FAULTY if faulty else NOMINAL):
                time_ns += int(chance.uniform(*PAUSE_S) * 1e9)
                yield time_ns, lamp, value, faulty and step == STRANGE_STEP
            cycle += 1


def nominal_log(cycles: int = 400) -> Log:
    """What the lamps do when nothing is wrong, as a tap at 10 ms sees it."""
    chance = random.Random(1)
    rows = []
    time_ns = 1_700_000_000_000_000_000
    poll_ns = int(POLL_S * 1e9)
    for _ in range(cycles):
        for lamp, value in NOMINAL:
            time_ns += int(chance.uniform(*PAUSE_S) * 1e9)
            rows.append((-(-time_ns // poll_ns) * poll_ns, lamp, value))
    times, lamps, values = zip(*rows, strict=True)
    return Log.from_columns(
        np.array(times, np.int64),
        np.array(lamps, np.uint32),
        np.array(values, np.int64),
        NAMES,
        scan_interval_s=POLL_S,
    )


async def be_the_plc(seconds: float) -> None:
    """Serves the lamps, says where, and at the end when they did what nobody learned."""
    clock = SteadyClock()
    lamps = Lamps(clock.now_ns(), seed=2)
    async with serve(lamps, "modbus://127.0.0.1:0", clock) as plc:
        print(plc.tap_url, flush=True)
        await asyncio.sleep(seconds)
    print(json.dumps(lamps.strange_ns), flush=True)


def measured(seconds: float) -> list[float]:
    """Milliseconds from each strange change to its finding being read from the pipe."""
    with tempfile.TemporaryDirectory() as directory:
        model = Path(directory) / "lamps.model"
        symbols = Path(directory) / "symbols.csv"
        rows = [f"{s.address},{s.group},{s.device},{s.signal},input" for s in Lamps.symbols]
        symbols.write_text("\n".join(["address,group,device,signal,class", *rows]) + "\n", "utf-8")
        learn(nominal_log(), symbols=symbols).save(model)
        plc = _started("benches.latency", "--plc", str(seconds + 2))
        assert plc.stdout is not None
        url = plc.stdout.readline().strip()
        options = ("--format", "jsonl", "--for", f"{seconds}s")
        watch = _started("runglight", "watch", str(model), url, *options)
        assert watch.stdout is not None
        heard: list[tuple[int, dict[str, str]]] = []
        listening = threading.Thread(target=_listen, args=(watch.stdout, heard))
        listening.start()
        truth_ns = json.loads(plc.stdout.readline())
        for process in (plc, watch):
            process.wait(60)
        listening.join()
    return _latencies_ms(truth_ns, heard)


def _latencies_ms(truth_ns: list[int], heard: list[tuple[int, dict[str, str]]]) -> list[float]:
    told: set[str] = set()
    latencies = []
    for heard_ns, finding in heard:
        if finding["id"] in told or finding["to"] != "Line-Lamp-B_OFF":
            continue
        told.add(finding["id"])
        # The change this one is about: the last that the tap can have seen.
        since_1970_ns = np.datetime64(finding["time"].removesuffix("Z"), "ns").astype(np.int64)
        position = bisect_right(truth_ns, int(since_1970_ns)) - 1
        latencies.append((heard_ns - truth_ns[position]) / 1e6)
    return latencies


def _listen(stream: TextIO, heard: list[tuple[int, dict[str, str]]]) -> None:
    for line in stream:
        heard_ns = time.time_ns()
        heard.append((heard_ns, json.loads(line)))


def _sleep_lightly(seconds: float, overslept_ms: list[float]) -> None:
    # How far a process that does nothing is late on this computer: on a busy one, most of it.
    end_s = time.perf_counter() + seconds
    while time.perf_counter() < end_s:
        began_s = time.perf_counter()
        time.sleep(POLL_S)
        overslept_ms.append((time.perf_counter() - began_s - POLL_S) * 1e3)


def _started(module: str, *arguments: str) -> "subprocess.Popen[str]":
    command = [sys.executable, "-m", module, *arguments]
    return subprocess.Popen(command, stdout=subprocess.PIPE, encoding="utf-8")


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--plc", type=float, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.plc is not None:
        asyncio.run(be_the_plc(arguments.plc))
        return
    overslept_ms: list[float] = []
    sleeper = threading.Thread(target=_sleep_lightly, args=(arguments.seconds, overslept_ms))
    sleeper.start()
    latencies = measured(arguments.seconds)
    sleeper.join()
    if not latencies:
        sys.exit("nothing was found: no measurement")
    p50, p99 = np.percentile(latencies, (50, 99))
    print(
        f"change in the PLC to finding printed, Modbus at 10 ms: p50 {p50:.1f} ms, "
        f"p99 {p99:.1f} ms, longest {max(latencies):.1f} ms, {len(latencies)} findings "
        f"(aim: p99 {AIM_P99_MS:g} ms)"
    )
    p50, p99 = np.percentile(overslept_ms, (50, 99))
    print(
        f"of which this computer's own: a sleep of 10 ms took p50 {p50:.1f} ms, p99 {p99:.1f} ms "
        "longer meanwhile"
    )


if __name__ == "__main__":
    main()
