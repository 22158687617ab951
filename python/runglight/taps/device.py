"""What a polled tap asks of a protocol: connect, read everything once, close."""

from typing import Protocol

import numpy as np
import numpy.typing as npt

from runglight.taps.base import Answer, TapSignal


class DeviceError(Exception):
    """A device did not give what was asked; its text is part of a sentence for people."""


class DeviceLostError(DeviceError):
    """The connection is gone or of no more use: connect anew."""


class WrongAnswerError(DeviceError):
    """One reply makes no sense (short, of another unit, garbled): worth asking once more."""


class Layout(Protocol):
    """What one read of a device means."""

    signals: list[TapSignal]
    """In the order of the values: inputs before outputs before memory."""

    def values(self, image: bytes) -> npt.NDArray[np.int64]:
        """The value of every signal in an image that `read` gave."""


class Device(Layout, Protocol):
    """One PLC as a scanner sees it.

    Methods raise DeviceLostError and WrongAnswerError. `connect` raises InputError for what can
    never work, as long as the device has not answered yet.
    """

    async def connect(self) -> None:
        """Connects anew, letting go of an earlier connection."""

    async def read(self) -> bytes:
        """All signals as they stand. Equal bytes mean equal values."""

    async def check(self) -> list[Answer]:
        """Asks for every signal once, on the open connection."""

    async def close(self) -> None:
        """Lets go of the connection. May be called twice."""


class BlockingDevice(Layout, Protocol):
    """A device whose library blocks; all methods are called by one thread. See `Device`."""

    def connect(self) -> None:
        """Connects anew, letting go of an earlier connection."""

    def read(self) -> bytes:
        """All signals as they stand."""

    def check(self) -> list[Answer]:
        """Asks for every signal once, on the open connection."""

    def close(self) -> None:
        """Lets go of the connection. May be called twice."""
