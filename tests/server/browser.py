"""A served cell that breaks when a browser is ready, and the script that looks at its page."""

import asyncio
import json
import shutil
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from runglight.plants.cell.running import RunningCell
from runglight.plants.cell.simulate import START_NS
from runglight.server.application import page_directory
from runglight.server.policy import policy
from runglight.server.running import PageServer, address_of, listen
from runglight.server.workshop import Workshop
from runglight.softplc import serve
from runglight.taps.virtual_clock import VirtualClock

ROOT = Path(__file__).parents[2]
GUARD_S = 300
SECOND_NS = 1_000_000_000
SEED = 5
BROKEN_AFTER_NS = 200 * SECOND_NS
WATCHED_BEFORE_NS = 45 * SECOND_NS
REAL_BEFORE_NS = 2 * SECOND_NS


def missing() -> str | None:
    """Why no browser can look at the page here."""
    if shutil.which("node") is None or shutil.which("chromium") is None:
        return "needs node and chromium"
    if not (ROOT / "web/node_modules/playwright-core").is_dir():
        return "needs npm ci in web"
    if not (page_directory() / "index.html").is_file():
        return "the page is not built"
    return None


@dataclass
class Seen:
    """What the script told, and when the PLC did what it told of."""

    told: list[dict[str, Any]] = field(default_factory=list)
    shown_ms: float = 0.0
    errors: str = ""

    def __getitem__(self, key: str) -> Any:
        found = [each[key] for each in self.told if key in each]
        assert found, f"the script did not get to {key!r}: {self.errors}"
        return found[0]


async def look(
    directory: Path,
    fault: str,
    script: str,
    hear: Callable[[dict[str, Any]], None] | None = None,
    guard_s: float = GUARD_S,
) -> Seen:
    """Serves a directory with a live cell, breaks it, and lets a script look at the page.

    `hear` is given what the script tells when it tells it.
    """
    shown_ns = _foreseen(fault)
    clock = VirtualClock(shown_ns - WATCHED_BEFORE_NS)
    plant = RunningCell(START_NS, SEED)
    plant.inject(fault, START_NS + BROKEN_AFTER_NS)
    seen = Seen()

    def real(now_ns: int) -> None:
        if not clock.is_real and now_ns >= shown_ns - REAL_BEFORE_NS:
            clock.run_on()
            seen.shown_ms = (time.time_ns() + shown_ns - clock.now_ns()) / 1e6

    async with serve(plant, "modbus://127.0.0.1:0", clock) as plc:
        workshop = Workshop(directory, policy(), source=plc.tap_url, clock=clock)
        listening = listen("127.0.0.1", 0)
        server = PageServer(workshop, listening)
        with clock.hold():
            serving = asyncio.create_task(server.run())
            process = await asyncio.create_subprocess_exec(
                "node",
                str(ROOT / "web/e2e" / script),
                address_of(listening),
                stdout=asyncio.subprocess.PIPE,
                stderr=asyncio.subprocess.PIPE,
                limit=1 << 22,
            )
            assert process.stdout is not None
            assert process.stderr is not None
            seen.told.append(json.loads(await process.stdout.readline() or '{"ended": true}'))
            clock.on_advance(real)
        try:
            async with asyncio.timeout(guard_s):
                async for line in process.stdout:
                    seen.told.append(json.loads(line))
                    if hear is not None:
                        hear(seen.told[-1])
                seen.errors = (await process.stderr.read()).decode()
                await process.wait()
        except TimeoutError:
            seen.errors = f"it was not done after {guard_s:g} s"
        finally:
            if process.returncode is None:
                process.terminate()
                await process.wait()
        server.stop()
        await serving
        listening.close()
    return seen


def _foreseen(fault: str) -> int:
    """When the fault shows: the same machine run ahead."""
    twin = RunningCell(START_NS, SEED)
    twin.inject(fault, START_NS + BROKEN_AFTER_NS)
    now_ns = START_NS
    while now_ns < START_NS + 3600 * SECOND_NS:
        now_ns += SECOND_NS
        twin.advance(now_ns)
        for label in twin.labels():
            if label.shown_ns is not None:
                return label.shown_ns
    raise AssertionError("the fault does not show")
