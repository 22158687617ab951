"""The live watch of the page: one session, started anew when the model or the set-up changes."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from runglight.errors import RunglightError
from runglight.live.batch_watcher import BatchWatcher
from runglight.live.keeper import Keeper
from runglight.live.session import Session
from runglight.live.signal_names import model_names
from runglight.log.symbols import names_by_address, read_symbols
from runglight.server.live_feed import LiveFeed
from runglight.taps import is_live, open_tap
from runglight.taps.named import NamedTap

if TYPE_CHECKING:
    from collections.abc import Callable

    from runglight.configuration import Configuration
    from runglight.live.status import Status
    from runglight.model import NominalModel
    from runglight.taps.base import Batch, Tap
    from runglight.taps.clock import Clock

TRY_AGAIN_S = 5.0


class Watching(msgspec.Struct, frozen=True):
    """How the live watch stands."""

    state: str
    """`off` (nothing to watch), `failed`, or the state of the connection."""
    reason: str | None = None
    status: Status | None = None


class LiveWatch:
    """Watches `[source] url` with a model, or without one just looks and records.

    `tell` is given lines of findings; `begun` is called when a session has a feed; `show` four
    times a second. All of it happens in the event loop.
    """

    def __init__(
        self,
        *,
        tell: Callable[[list[str]], None],
        begun: Callable[[LiveFeed], None],
        show: Callable[[], None],
        say: Callable[[str], None],
        clock: Clock | None = None,
    ) -> None:
        self._tell = tell
        self._begun = begun
        self._show = show
        self._say = say
        self._clock = clock
        self._session: Session | None = None
        self._keeper: Keeper | None = None
        self._running: asyncio.Task[None] | None = None
        self._why_not: str | None = None
        self._failed = False
        self.feed: LiveFeed | None = None
        self.name_of: Callable[[object], str] | None = None

    @property
    def watching(self) -> Watching:
        """How it stands."""
        if self._session is None:
            return Watching("failed" if self._failed else "off", self._why_not)
        status = self._session.status()
        return Watching(status.state, status.reason, status)

    def start(
        self, configuration: Configuration, model: NominalModel | None, directory: Path | None
    ) -> None:
        """Begins; `directory` is the model's."""
        url = configuration.source.url
        self._failed = False
        if url is None or not is_live(url):
            self._why_not = 'no live source is configured: write url = "modbus://…" under [source]'
            return
        self._why_not = "connecting"
        self._running = asyncio.create_task(self._run(url, configuration, model, directory))

    async def stop(self) -> None:
        """Ends it, with everything kept."""
        if self._session is not None:
            self._session.stop()
        running, self._running = self._running, None
        if running is not None:
            if self._session is None:
                running.cancel()
            await asyncio.gather(running, return_exceptions=True)
        self._session = self._keeper = None

    def keep(self, lines: list[str]) -> bool:
        """Hands lines to the session's own store; False where no session keeps any."""
        if self._keeper is None:
            return False
        self._keeper.put(lines, [])
        return True

    async def _run(
        self,
        url: str,
        configuration: Configuration,
        model: NominalModel | None,
        directory: Path | None,
    ) -> None:
        while True:
            try:
                await self._watch(url, configuration, model, directory)
            except (RunglightError, OSError, ModuleNotFoundError) as error:
                # A PLC that refuses an address today may have it tomorrow.
                self._failed, self._why_not = True, str(error)
                self._session = self._keeper = None
                self._say(str(error))
                self._show()
                await asyncio.sleep(TRY_AGAIN_S)
            else:
                self._why_not = "the source has ended"
                self._session = self._keeper = None
                return

    async def _watch(
        self,
        url: str,
        configuration: Configuration,
        model: NominalModel | None,
        directory: Path | None,
    ) -> None:
        tap = open_tap(url, interval=configuration.source.interval, clock=self._clock)
        async with _named(tap, configuration) as tap:
            feed = LiveFeed(tap, self._say)
            keeper = Keeper(directory, self._say)
            watcher = (
                _Looking()
                if model is None
                else BatchWatcher(
                    model, model.monitor(), tap.signals, model_names(model, configuration.symbols)
                )
            )
            session = Session(
                tap,
                watcher,
                keeper,
                tell=self._tell,
                say=self._say,
                show=lambda _status: self._show(),
                recording=feed,
                replayed=url.lower().startswith("replay:"),
            )
            self.feed, self._session, self._keeper = feed, session, keeper
            self._failed = False
            self._begun(feed)
            await session.run()


class _Looking:
    """Watches nothing: there is no model yet, and the machine is only looked at."""

    late_rows = 0

    def take(self, batch: Batch) -> list[str]:
        return []

    def complete(self) -> list[str]:
        return []

    def take_snapshots(self) -> list[str]:
        return []

    def state(self) -> bytes:
        return b""


def _named(tap: Tap, configuration: Configuration) -> Tap:
    symbols = configuration.symbols
    if symbols.table is None:
        return tap
    return NamedTap(tap, names_by_address(read_symbols(Path(symbols.table)), symbols.naming))
