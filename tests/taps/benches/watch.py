"""A tap in a process of its own: `python -m tests.taps.benches.watch URL`.

Prints a JSON line for each batch that has rows or marks, and when the connection is lost; ends
when its standard input does.
"""

import asyncio
import json
import sys
from typing import Any

from runglight.taps import open_tap
from runglight.taps.base import ConnectionState, Gap, Tap

LOOK_AGAIN_S = 0.005


async def _tell_batches(tap: Tap) -> None:
    async for batch in tap:
        if not len(batch) and not batch.marks:
            continue
        gaps = [(mark.start_ns, mark.end_ns) for mark in batch.marks if isinstance(mark, Gap)]
        _tell(
            image=batch.image,
            gaps=gaps,
            values=batch.value.tolist(),
            time_ns=batch.until_ns,
            reconnects=tap.connection.reconnects,
        )


async def _tell_losses(tap: Tap) -> None:
    lost = False
    while True:
        was_lost, lost = lost, tap.connection.state is ConnectionState.RETRYING
        if lost and not was_lost:
            _tell(state="retrying")
        await asyncio.sleep(LOOK_AGAIN_S)


def _tell(**told: Any) -> None:
    print(json.dumps(told), flush=True)


async def _watch(url: str) -> None:
    async with open_tap(url) as tap:
        telling = [asyncio.create_task(_tell_batches(tap)), asyncio.create_task(_tell_losses(tap))]
        await asyncio.to_thread(sys.stdin.read)
        for task in telling:
            task.cancel()
        await asyncio.gather(*telling, return_exceptions=True)


if __name__ == "__main__":
    asyncio.run(_watch(sys.argv[1]))
