"""A camera before a served plant: its photos fill a folder, which a recorder can watch."""

import asyncio

from runglight.plants.photo_folder import PhotoFolder
from runglight.softplc.plc import SoftPlc
from runglight.taps.clock import Clock
from runglight.taps.grid import Grid


async def keep_photographing(
    plc: SoftPlc, folder: PhotoFolder, clock: Clock, interval_ns: int
) -> None:
    """Takes a photo now and every `interval_ns` from then on, until cancelled.

    Each shows the machine at the very time it is named by. What it overslept is left out.
    """
    grid = Grid(interval_ns)
    while True:
        await clock.sleep_until(grid.next_ns(clock.now_ns()))
        # Drawing takes longer than a scan: the PLC answers meanwhile.
        develop = plc.expose()
        folder.put(await asyncio.to_thread(develop))
