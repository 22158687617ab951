"""How soon a fault is on the page: `python -m benches.live_page [MINUTES]`.

From the change in the PLC, over Modbus at 10 ms, monitor and server-sent events, to the browser's
document. With minutes, the live tail is then looked at for so long, and the memory told of the
browser and of the server (which here is one process with the simulated PLC and its machine).
"""

import asyncio
import json
import os
import sys
import tempfile
from pathlib import Path
from typing import Any

from runglight.log.changelog import Log
from runglight.model import learn
from runglight.plants import PLANTS, write_symbols
from tests.server.browser import GUARD_S, look, missing

FAULT = "prt-chk-on-while-returning"
RUNS = 3


def main() -> None:
    """Prints one JSON line a run."""
    if (why := missing()) is not None:
        raise SystemExit(why)
    run = PLANTS["cell"].simulate(cycles=20, seed=1)
    log = Log.from_columns(run.time_ns, run.signal_index, run.value, run.signals)
    for number in range(RUNS):
        last = number == RUNS - 1
        minutes = int(sys.argv[1]) if last and len(sys.argv) > 1 else 0
        os.environ["MINUTES"] = str(minutes)
        with tempfile.TemporaryDirectory() as name:
            directory = Path(name)
            write_symbols(PLANTS["cell"].symbols, directory / "symbols.csv")
            learn(log, symbols=directory / "symbols.csv").save(directory / "cell.model")
            seen = asyncio.run(look(directory, FAULT, "live.mjs", _weigh, GUARD_S + 90 * minutes))
        latency_ms = round(seen["appeared_ms"] - seen.shown_ms, 1)
        print(json.dumps({"run": number + 1, "on_the_page_after_ms": latency_ms}))
        if seen.errors:
            print(seen.errors)


def _weigh(told: dict[str, Any]) -> None:
    """Prints each minute with what the server then held in memory."""
    if "minute" in told:
        status = Path("/proc/self/status").read_text(encoding="utf-8")
        kilobytes = next(line.split()[1] for line in status.splitlines() if "VmRSS" in line)
        print(json.dumps(told | {"server_mb": round(int(kilobytes) / 1024, 1)}), flush=True)


if __name__ == "__main__":
    main()
