"""A session over a double tap, and waiting for what it does."""

import asyncio
from collections.abc import Callable
from pathlib import Path

from runglight.live.batch_watcher import BatchWatcher
from runglight.live.keeper import Keeper
from runglight.live.session import Session
from runglight.log.changelog import Log
from runglight.model import NominalModel
from tests.live.double_tap import DoubleTap

GUARD_S = 300.0


class Watching:
    """Everything a session needs, with what it told and said kept."""

    def __init__(self, model: NominalModel, directory: Path, log: Log, **options: object) -> None:
        self.told: list[str] = []
        self.said: list[str] = []
        self.tap = DoubleTap(log.signals)
        self.keeper = Keeper(directory, self.said.append)
        watcher = BatchWatcher(model, model.monitor(), self.tap.signals, lambda each: each.name)
        self.session = Session(
            self.tap,
            watcher,
            self.keeper,
            tell=self.told.extend,
            say=self.said.append,
            **options,  # type: ignore[arg-type]
        )


async def until(what: Callable[[], bool]) -> None:
    """Waits until something is so."""
    async with asyncio.timeout(GUARD_S):
        while not what():
            await asyncio.sleep(0.01)
