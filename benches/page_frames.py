"""Frames of the timing diagram over five million edges: `python -m benches.page_frames`.

Software rendering, a real browser; needs what `tests/server/browser.py` needs.
"""

import asyncio
import json
import tempfile
import time
from pathlib import Path

import numpy as np

from runglight import _engine
from runglight.log.changelog import Log
from runglight.server.policy import policy
from runglight.server.running import PageServer, address_of, listen
from runglight.server.workshop import Workshop
from tests.server.browser import ROOT, missing

EDGES = 5_000_000
SIGNALS = 300
LENGTH_NS = 8 * 3600 * 1_000_000_000
START_NS = 1_767_592_800_000_000_000


def large_log() -> Log:
    """Signals of very different business, from a change an hour to thousands a second in bursts."""
    random = np.random.default_rng(1)
    weight = random.pareto(1.0, SIGNALS) + 0.05
    signal = random.choice(SIGNALS, EDGES, p=weight / weight.sum()).astype(np.uint32)
    time_ns = np.sort(random.integers(0, LENGTH_NS, EDGES)) + START_NS
    value = np.empty(EDGES, np.int64)
    for each in range(SIGNALS):
        rows = np.flatnonzero(signal == each)
        # Every tenth is a word.
        value[rows] = np.arange(len(rows)) % (2 if each % 10 else 1000)
    names = [f"Group{n // 60}-Device{n // 6}-Signal{n}" for n in range(SIGNALS)]
    return Log.from_columns(time_ns, signal, value, names)


async def look(directory: Path) -> None:
    """Serves the log and lets the browser zoom and pan it."""
    workshop = Workshop(directory, policy())
    listening = listen("127.0.0.1", 0)
    server = PageServer(workshop, listening)
    serving = asyncio.create_task(server.run())
    [item] = workshop.catalogue.items("log")
    process = await asyncio.create_subprocess_exec(
        "node", str(ROOT / "web/e2e/frames.mjs"), address_of(listening), item.id
    )
    await process.wait()
    server.stop()
    await serving


def main() -> None:
    """Prints one JSON line a measurement."""
    if (why := missing()) is not None:
        raise SystemExit(why)
    log = large_log()
    began = time.perf_counter()
    diagram = _engine.TimingDiagram(log.engine)
    built_s = time.perf_counter() - began
    lanes = list(range(40))
    took = []
    for part in (1, 3, 10, 100, 1000, 100_000):
        began = time.perf_counter()
        diagram.spans(lanes, START_NS, START_NS + LENGTH_NS // part, 3000)
        took.append(time.perf_counter() - began)
    print(
        json.dumps(
            {
                "edges": len(log),
                "diagram_built_s": round(built_s, 3),
                "window_of_40_lanes_ms": [round(each * 1e3, 2) for each in took],
            }
        )
    )
    with tempfile.TemporaryDirectory() as name:
        log.write(Path(name) / "large.parquet")
        asyncio.run(look(Path(name)))


if __name__ == "__main__":
    main()
