"""One recording from start to end: a tap, a recorder, perhaps a camera."""

from __future__ import annotations

import asyncio
from collections.abc import Callable

from runglight.recording.camera import Camera
from runglight.recording.meter import Meter
from runglight.recording.recorder import Recorder
from runglight.taps.base import ConnectionState, Tap

TICK_S = 0.25
_BATCHES_AT_ONCE = 64


async def record(
    tap: Tap,
    recorder: Recorder,
    *,
    meter: Meter,
    camera: Camera | None = None,
    for_s: float | None = None,
    tick: Callable[[], None] = lambda: None,
) -> None:
    """Records until the tap ends, `for_s` of its time have passed, or this is cancelled.

    Calls `tick` four times a second. InputError where recording had to stop.
    """
    loop = asyncio.get_running_loop()
    began_s = loop.time()
    taking = asyncio.create_task(_take(tap, recorder, meter, for_s))
    tasks: list[asyncio.Task[None]] = [taking]
    if camera is not None:
        tasks.append(asyncio.create_task(camera.run()))
    try:
        while not taking.done():
            await asyncio.wait({taking}, timeout=TICK_S)
            recorder.check()
            tick()
            # A tap without a connection tells no time.
            away = tap.connection.state is not ConnectionState.CONNECTED
            if for_s is not None and away and loop.time() - began_s > for_s:
                return
        taking.result()
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


async def _take(tap: Tap, recorder: Recorder, meter: Meter, for_s: float | None) -> None:
    taken = 0
    async for batch in tap:
        recorder.append(batch)
        meter.take(batch)
        if for_s is not None and meter.recorded_s >= for_s:
            return
        taken += 1
        if taken % _BATCHES_AT_ONCE == 0:
            # A tap that always has a batch ready must not keep everything else waiting.
            await asyncio.sleep(0)
