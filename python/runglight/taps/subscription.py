"""What taps of sources that send by themselves (OPC UA, MQTT, Sparkplug B) have in common.

A subclass writes one session: connect, subscribe, put what comes into `arrivals`, and raise
`SourceLost` when the source is gone. Everything else is here: back-off and reconnecting, the state
of the connection, heartbeats, the end.
"""

import asyncio
from abc import abstractmethod
from collections.abc import AsyncGenerator, AsyncIterator
from contextlib import suppress
from typing import ClassVar

from runglight.errors import InputError
from runglight.quantities import duration_s
from runglight.taps.arrivals import Arrivals
from runglight.taps.backoff import Backoff
from runglight.taps.base import Batch, Connection, ConnectionState, Tap, TapSignal
from runglight.taps.clock import Clock
from runglight.taps.left_out import LeftOut
from runglight.taps.url import SourceUrl

YES = {"yes": True, "true": True, "1": True, "on": True}
NO = {"no": False, "false": False, "0": False, "off": False}
MOST_WAITING = 1_000_000
"""Values; a reader that far behind loses the connection, which shows as a gap."""
LOOK_AGAIN_S = 0.05
REORDER_S = 0.05
"""Every finding waits for it; enough for one server, and for publishers in one network."""
INT64 = range(-(1 << 63), 1 << 63)


class SourceLost(Exception):  # noqa: N818 — the source is lost, nothing is wrong with the program.
    """The source cannot be reached now; its text is one sentence for people."""


class SubscribedTap(Tap):
    """A tap whose source sends changes by itself."""

    losses: ClassVar[tuple[type[Exception], ...]] = (SourceLost, OSError, EOFError)
    """What the library of the protocol raises when the source is gone; subclasses add to it."""

    stamped: ClassVar[bool] = True
    """Whether every value of the source carries a time stamp."""

    def __init__(self, url: SourceUrl, clock: Clock) -> None:
        self._source = url
        self._clock = clock
        self.url = url.text
        self.signals: list[TapSignal] = []
        self.connection = Connection()
        self.interval_ns = None
        self.left_out = LeftOut()
        self.timeout_s = self.duration("timeout", 2.0)
        reorder_s = self.duration("reorder", REORDER_S, zero=True)
        self.arrivals = Arrivals(clock, round(reorder_s * 1e9), stamped=self.stamped)
        self._indices: dict[str, int] = {}
        self._names: set[str] = set()
        self._backoff = Backoff()
        self._news = asyncio.Event()
        self._sessions: asyncio.Task[None] | None = None
        self._closed = False
        self._was_connected = False

    @property
    def notices(self) -> list[str]:
        """What people should know of the source: names left out, late and implausible times."""
        lines = self.left_out.sentences()
        if late := self.arrivals.late:
            lines.append(
                f"{late} values came later than reorder allows and are stamped as late as needed"
            )
        if implausible := self.arrivals.implausible:
            lines.append(
                f"{implausible} time stamps were more than an hour from this computer's clock "
                "and were replaced by the time of arrival"
            )
        return lines

    # What a subclass writes.

    @abstractmethod
    async def session(self) -> None:
        """Connects and receives until the source is lost, which it raises."""

    # What a subclass calls.

    def duration(self, option: str, default_s: float, *, zero: bool = False) -> float:
        """Seconds of an option of the URL."""
        text = self._source.options.get(option)
        if text is None:
            return default_s
        seconds = duration_s(text, f"{self._source.text}: {option}")
        if seconds == 0 and not zero:
            raise InputError(f"{self._source.text}: {option} must be above zero")
        return seconds

    def switch(self, option: str, default: bool) -> bool:
        """Yes or no of an option of the URL."""
        text = self._source.options.get(option)
        if text is None:
            return default
        answer = (YES | NO).get(text.lower())
        if answer is None:
            raise InputError(f"{self._source.text}: {option} is {text!r}; write yes or no")
        return answer

    def index_of(self, signal: TapSignal) -> int:
        """The index of a signal, by its address; a new one is added, under a name of its own."""
        index = self._indices.get(signal.address)
        if index is None:
            if signal.name in self._names:
                signal = TapSignal(
                    name=f"{signal.name}({signal.address})",
                    address=signal.address,
                    type=signal.type,
                    signal_class=signal.signal_class,
                    description=signal.description,
                )
            index = self._indices[signal.address] = len(self.signals)
            self._names.add(signal.name)
            self.signals.append(signal)
        return index

    def connected(self) -> None:
        """The source answers and the image is complete."""
        self._backoff.reset()
        reconnects = self.connection.reconnects + self._was_connected
        self._was_connected = True
        self.connection = Connection(ConnectionState.CONNECTED, reconnects)
        self.wake()

    def wake(self) -> None:
        """Something was put into `arrivals`; SourceLost where nobody has taken it for long."""
        self._news.set()
        if self.arrivals.waiting > MOST_WAITING:
            raise SourceLost("the reader does not keep up with the source")

    @property
    def was_connected(self) -> bool:
        """Whether the source ever answered: what it refuses now can then pass again."""
        return self._was_connected

    # The contract.

    def __aiter__(self) -> AsyncIterator[Batch]:
        return self._batches()

    async def close(self) -> None:
        """Lets go of the source; an iteration under way ends."""
        self._closed = True
        self.connection = Connection(ConnectionState.CLOSED, self.connection.reconnects)
        self._news.set()
        await self._end_sessions()

    async def _end_sessions(self) -> None:
        sessions = self._sessions
        if sessions is not None and sessions is not asyncio.current_task():
            sessions.cancel()
            # Its own error, if any, is told by the iteration.
            await asyncio.wait([sessions])

    async def _batches(self) -> AsyncGenerator[Batch]:
        if self._sessions is not None:
            raise RuntimeError("a tap is iterated once")
        sessions = self._sessions = asyncio.create_task(self._keep_connected())
        sessions.add_done_callback(lambda _: self._news.set())
        try:
            while not self._closed:
                self._news.clear()
                for batch in self.arrivals.take():
                    yield batch
                if sessions.done():
                    if not sessions.cancelled():
                        sessions.result()
                    return
                wait_ns = max(self.arrivals.next_due_ns() - self._clock.now_ns(), 1_000_000)
                with suppress(TimeoutError):
                    await asyncio.wait_for(self._news.wait(), wait_ns / 1e9)
        finally:
            await self._end_sessions()

    async def _keep_connected(self) -> None:
        while True:
            while self.arrivals.unread:
                await asyncio.sleep(LOOK_AGAIN_S)
            try:
                await self.session()
                reason = "the source ended the connection"
            except self.losses as error:
                reason = _sentence(error)
            self.arrivals.lost(reason)
            self.connection = Connection(
                ConnectionState.RETRYING, self.connection.reconnects, reason
            )
            self.wake()
            await asyncio.sleep(self._backoff.wait_ns() / 1e9)


def _sentence(error: Exception) -> str:
    """One line for an error of a library; some carry no text at all."""
    text = " ".join(str(error).split())
    if isinstance(error, TimeoutError):
        return text or "no answer in time"
    return text or type(error).__name__
