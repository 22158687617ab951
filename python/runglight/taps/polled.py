"""What the polled taps share: interval, time-out, where the scanner runs, checking."""

from abc import abstractmethod
from collections.abc import AsyncIterator

from runglight.errors import InputError
from runglight.quantities import duration_s
from runglight.taps.base import Answer, Batch, Connection, ConnectionState, Tap, TapSignal
from runglight.taps.clock import Clock, SteadyClock
from runglight.taps.device import Device, DeviceError
from runglight.taps.running import InLoop, OwnThread, Running
from runglight.taps.scanner import Scanner
from runglight.taps.url import SourceUrl

INTERVAL = "10ms"
TIMEOUT = "500ms"


class PolledTap(Tap):
    """A tap that asks for all its signals again and again.

    In the computer's time the scanner has a thread of its own; in a simulated machine's time it
    runs in the reader's event loop, one batch at a time.
    """

    interval_ns: int

    def __init__(self, url: SourceUrl, clock: Clock, signals: list[TapSignal]) -> None:
        self.url = url.text
        self.signals = signals
        self.connection = Connection()
        interval = url.options.get("interval", INTERVAL)
        self.interval_ns = round(duration_s(interval, f"{url.text}: interval") * 1e9)
        self._source = url
        self._clock = clock
        self._running: Running | None = None
        self._closed = False

    @abstractmethod
    def device(self, *, own_thread: bool) -> Device:
        """A new device; with `own_thread` it may block the thread it is used in."""

    async def __aiter__(self) -> AsyncIterator[Batch]:
        """The batches, until the tap is closed."""
        if self._closed:
            return
        own_thread = isinstance(self._clock, SteadyClock)
        if not own_thread and not self.interval_ns:
            raise InputError(
                f"{self.url}: interval=0 takes no time of its own; write interval=10ms"
            )
        scanner = Scanner(
            self.device(own_thread=own_thread), self._clock, self.interval_ns, self._hear
        )
        running: Running
        if own_thread:
            running = OwnThread(scanner.batches, f"runglight-{self._source.scheme}")
        else:
            running = InLoop(scanner.batches)
        self._running = running
        try:
            while (batch := await running.next()) is not None:
                yield batch
        finally:
            await running.stop()

    async def check(self) -> list[Answer]:
        """Reads every configured signal once; InputError where the source cannot be reached."""
        device = self.device(own_thread=False)
        try:
            return await device.check()
        except DeviceError as error:
            raise InputError(
                f"{self.url}: {error}; is the PLC running, and reachable from this computer at "
                f"{self._source.host} port {self._source.port}?"
            ) from None
        finally:
            await device.close()

    async def close(self) -> None:
        """Lets go of the source; an iteration under way ends."""
        self._closed = True
        if self._running is not None:
            await self._running.stop()
        self.connection = Connection(ConnectionState.CLOSED, self.connection.reconnects)

    def _hear(self, connection: Connection) -> None:
        if not self._closed:
            self.connection = connection


def timeout_s(url: SourceUrl) -> float:
    """Longest wait for one reply: option `timeout`, half a second where it is not given."""
    seconds = duration_s(url.options.get("timeout", TIMEOUT), f"{url.text}: timeout")
    if seconds <= 0:
        raise InputError(f"{url.text}: timeout must be above zero; leave it out for {TIMEOUT}")
    return seconds
