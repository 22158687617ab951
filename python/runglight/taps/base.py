"""The seam through which live signals come in: a tap is an asynchronous iterator of batches.

Stated once, for every tap (Modbus, S7, OPC UA, MQTT, replay):

- `async with open_tap(url) as tap: async for batch in tap: …`. A tap is iterated once.
- Rows come in time order, within a batch and from batch to batch; inputs before outputs within one
  scan (Theis 2019, section 4.1). A row tells a change, except in an *image*: the first rows after
  the start and after every gap are all signals as they stand (`Batch.image`).
- A lost connection never ends the iteration and never raises: the tap retries with back-off, says
  so in `Tap.connection`, and the batch after it carries a `Gap`. While nothing comes, empty
  batches with a later `until_ns` say that time goes on (at least every `QUIET_NS` while
  connected), so that stalls are found.
- What can never work (an unknown option, an address the device has not) raises `InputError`.
- Times are stamped by the tap's `Clock`, as close to the read as possible. They never run
  backwards; a step of the computer's clock is told as a `ClockStep`.
- `Tap.signals` only ever grows; indices stay.
- Nothing is ever written to the PLC.
"""

from abc import ABC, abstractmethod
from collections.abc import AsyncIterator
from dataclasses import dataclass, field
from enum import StrEnum
from types import TracebackType
from typing import Self

import numpy as np
import numpy.typing as npt

QUIET_NS = 100_000_000
"""Longest silence between two batches of a connected tap."""


class ConnectionState(StrEnum):
    """What a tap is doing about its source."""

    CONNECTING = "connecting"
    CONNECTED = "connected"
    RETRYING = "retrying"
    CLOSED = "closed"


@dataclass(frozen=True, slots=True)
class Connection:
    """The state of a tap's connection, for people: `reason` is one sentence while retrying."""

    state: ConnectionState = ConnectionState.CONNECTING
    reconnects: int = 0
    reason: str | None = None


@dataclass(frozen=True, slots=True)
class TapSignal:
    """A signal that a tap delivers: its name in the log, and where the PLC keeps it."""

    name: str
    address: str
    type: str = "BOOL"
    """IEC 61131-3 elementary type: BOOL, INT, UINT, WORD, BYTE, DINT …"""
    signal_class: str = "input"
    """`input`, `output` or `memory`."""
    description: str = ""


@dataclass(frozen=True, slots=True)
class Gap:
    """Nothing was seen between two times."""

    start_ns: int
    end_ns: int
    reason: str


@dataclass(frozen=True, slots=True)
class ClockStep:
    """At `time_ns` the computer's clock jumped by `step_ns`; the tap's times ran on steadily."""

    time_ns: int
    step_ns: int


Mark = Gap | ClockStep


def _no_times() -> npt.NDArray[np.int64]:
    return np.empty(0, np.int64)


def _no_indices() -> npt.NDArray[np.uint32]:
    return np.empty(0, np.uint32)


@dataclass(frozen=True, slots=True)
class Batch:
    """What one or several scans saw: three columns of one length, rows in time order."""

    until_ns: int
    """Everything that happened up to here is in this batch or an earlier one."""
    time_ns: npt.NDArray[np.int64] = field(default_factory=_no_times)
    signal_index: npt.NDArray[np.uint32] = field(default_factory=_no_indices)
    """Indices into `Tap.signals`."""
    value: npt.NDArray[np.int64] = field(default_factory=_no_times)
    scan_ns: npt.NDArray[np.int64] = field(default_factory=_no_times)
    """Time of each scan of a polled tap, also of those that saw no change."""
    marks: tuple[Mark, ...] = ()
    """What happened before the first row."""
    image: bool = False
    """The rows are all signals as they stand, not changes."""

    def __len__(self) -> int:
        return len(self.time_ns)


@dataclass(frozen=True, slots=True)
class Answer:
    """Whether one signal of a source answers, for `runglight check`."""

    signal: TapSignal
    value: int | None
    error: str | None = None
    """One sentence where it does not."""


class Tap(ABC):
    """One live source. See the head of this file for the contract."""

    url: str
    """Where it taps, without secrets."""
    signals: list[TapSignal]
    """Grows only; known once entered, for taps that can know."""
    connection: Connection
    interval_ns: int | None
    """Time between two scans; None where the source sends by itself, 0 for as fast as it goes."""

    @abstractmethod
    def __aiter__(self) -> AsyncIterator[Batch]:
        """The batches, until the tap is closed (or a replayed log ends)."""

    @abstractmethod
    async def check(self) -> list[Answer]:
        """Reads every configured signal once; InputError where the source cannot be reached."""

    @abstractmethod
    async def close(self) -> None:
        """Lets go of the source; an iteration under way ends. May be called twice."""

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        await self.close()
