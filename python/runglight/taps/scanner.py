"""The loop of every polled tap: connect, scan on a grid of time, tell changes and gaps.

A scan has one time, taken directly after its last reply. The midpoint between request and reply
would be nearer to the moment at which the PLC looked, on average, but could lie before a change
that the scan already shows; a time after the reply never puts an effect before its cause, and is
at most one round trip late.
"""

from collections.abc import AsyncGenerator, Callable

from runglight.taps.backoff import Backoff
from runglight.taps.base import Batch, Connection, ConnectionState
from runglight.taps.clock import Clock
from runglight.taps.device import Device, DeviceError, DeviceLostError, WrongAnswerError
from runglight.taps.grid import Grid
from runglight.taps.scan_batches import ScanBatches

STRETCHED_INTERVALS = 5
STRETCHED_NS = 1_000_000_000
"""Longer than both without a scan: changes may have been missed, so that is a gap."""
BLURRED_NS = 100_000_000
"""Longer than this (and than so many intervals) before a scan that saw changes: when they came and
in which order is not known, and a guess would be an alarm. That is a gap, too."""


class Scanner:
    """Scans one device; `tell` hears of every change of the connection's state."""

    def __init__(
        self,
        device: Device,
        clock: Clock,
        interval_ns: int,
        tell: Callable[[Connection], None],
        backoff: Backoff | None = None,
    ) -> None:
        self._device = device
        self._clock = clock
        self._tell = tell
        self._grid = Grid(interval_ns)
        self._stretched_ns = max(STRETCHED_INTERVALS * interval_ns, STRETCHED_NS)
        self._blurred_ns = max(STRETCHED_INTERVALS * interval_ns, BLURRED_NS)
        self._backoff = backoff or Backoff()
        self._batches = ScanBatches(device.values, interval_ns)
        self._connection = Connection()

    async def batches(self) -> AsyncGenerator[Batch, None]:
        """Goes on for ever; InputError for what can never work. Closes the device at its end."""
        connected = False
        try:
            # From here on a simulated machine's time waits for this task, also while it connects.
            await self._clock.sleep_until(self._clock.now_ns())
            while True:
                try:
                    if not connected:
                        await self._device.connect()
                        connected = True
                    await self._clock.sleep_until(self._grid.next_ns(self._clock.now_ns()))
                    image = await self._read()
                except DeviceError as error:
                    connected = False
                    for batch in self._batches.lost(str(error)):
                        yield batch
                    await self._retry(str(error))
                    continue
                time_ns = self._clock.now_ns()
                if self._connection.state is not ConnectionState.CONNECTED:
                    self._answered()
                for batch in self._take(image, time_ns):
                    yield batch
        finally:
            await self._device.close()

    async def _read(self) -> bytes:
        try:
            return await self._device.read()
        except WrongAnswerError:
            pass
        try:
            return await self._device.read()
        except WrongAnswerError as again:
            raise DeviceLostError(f"two wrong answers in a row: {again}") from None

    def _take(self, image: bytes, time_ns: int) -> list[Batch]:
        earlier: list[Batch] = []
        last_ns = self._batches.last_ns
        longest_ns = self._blurred_ns if self._batches.is_change(image) else self._stretched_ns
        if last_ns is not None and time_ns - last_ns > longest_ns:
            stretched_s = (time_ns - last_ns) / 1e9
            earlier = self._batches.lost(
                f"no scan for {stretched_s:.1f} s: this computer or the PLC was too slow"
            )
        return [*earlier, *self._batches.take(image, time_ns, self._clock.take_step_ns())]

    def _answered(self) -> None:
        self._backoff.reset()
        lost = self._connection.state is ConnectionState.RETRYING
        again = lost and self._batches.last_ns is not None
        self._set(Connection(ConnectionState.CONNECTED, self._connection.reconnects + again, None))

    async def _retry(self, reason: str) -> None:
        self._set(Connection(ConnectionState.RETRYING, self._connection.reconnects, reason))
        await self._device.close()
        await self._clock.sleep_until(self._clock.now_ns() + self._backoff.wait_ns())

    def _set(self, connection: Connection) -> None:
        self._connection = connection
        self._tell(connection)
