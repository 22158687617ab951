"""Batches and taps made up for tests."""

import asyncio
import time
from collections.abc import AsyncIterator, Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from hypothesis import strategies as st

from runglight.recording.recorder import Recorder, SealAt
from runglight.taps.base import (
    Answer,
    Batch,
    ClockStep,
    Connection,
    ConnectionState,
    Gap,
    Mark,
    Tap,
    TapSignal,
)

START_NS = 1_767_225_600_000_000_000
SECOND = 1_000_000_000
SIGNALS = [
    TapSignal("A-B-ON", "%IX0.0"),
    TapSignal("A-B-OFF", "%QX0.0", signal_class="output"),
    TapSignal("A-C-STEP", "%MW3", "INT", "memory", "step of the sequence"),
    TapSignal("Zähler Ω", "40001", "DINT", "memory"),
]


def batch(
    until_s: float,
    rows: Sequence[tuple[float, int, int]] = (),
    scans_s: Sequence[float] = (),
    marks: Sequence[Mark] = (),
    image: bool = False,
) -> Batch:
    """A batch with times in seconds after `START_NS`; rows are time, signal and value."""
    return Batch(
        until_ns=at(until_s),
        time_ns=np.array([at(row[0]) for row in rows], np.int64),
        signal_index=np.array([row[1] for row in rows], np.uint32),
        value=np.array([row[2] for row in rows], np.int64),
        scan_ns=np.array([at(scan) for scan in scans_s], np.int64),
        marks=tuple(marks),
        image=image,
    )


def at(seconds: float) -> int:
    """Nanoseconds of a time in seconds after `START_NS`."""
    return START_NS + round(seconds * SECOND)


@st.composite
def batches(draw: st.DrawFn, most: int = 8) -> list[Batch]:
    """Any batches a tap may give, in time order."""
    now = START_NS
    made = []
    for _ in range(draw(st.integers(0, most))):
        marks: list[Mark] = []
        if draw(st.booleans()):
            start, now = now, now + draw(st.integers(0, 10**12))
            marks.append(Gap(start, now, draw(st.text("aäΩ;\0\n ", max_size=8))))
        if draw(st.booleans()):
            marks.append(ClockStep(now, draw(st.integers(-(10**13), 10**13))))
        steps = draw(
            st.lists(st.integers(0, draw(st.sampled_from([3, 10**6, 10**11]))), max_size=9)
        )
        scans = draw(st.lists(st.integers(0, 10**9), max_size=9))
        time_ns = now + np.cumsum(np.array(steps, np.int64), dtype=np.int64)
        scan_ns = now + np.cumsum(np.array(scans, np.int64), dtype=np.int64)
        now = max([now, *time_ns.tolist(), *scan_ns.tolist()]) + draw(st.integers(0, 1000))
        count = len(steps)
        values = st.one_of(st.integers(0, 1), st.integers(-(2**63), 2**63 - 1))
        made.append(
            Batch(
                until_ns=now,
                time_ns=time_ns,
                signal_index=np.array(
                    draw(st.lists(st.integers(0, 3), min_size=count, max_size=count)), np.uint32
                ),
                value=np.array(draw(st.lists(values, min_size=count, max_size=count)), np.int64),
                scan_ns=scan_ns,
                marks=tuple(marks),
                image=draw(st.booleans()),
            )
        )
    return made


def later(given: Batch, by_ns: int) -> Batch:
    """The same batch a little later."""
    return replace(
        given,
        until_ns=given.until_ns + by_ns,
        time_ns=given.time_ns + by_ns,
        scan_ns=given.scan_ns + by_ns,
        marks=tuple(
            replace(mark, start_ns=mark.start_ns + by_ns, end_ns=mark.end_ns + by_ns)
            if isinstance(mark, Gap)
            else replace(mark, time_ns=mark.time_ns + by_ns)
            for mark in given.marks
        ),
    )


def rows_of(given: Sequence[Batch]) -> list[tuple[int, str, int]]:
    """Time, name and value of every row."""
    return [
        (int(time_ns), SIGNALS[index].name, int(value))
        for each in given
        for time_ns, index, value in zip(each.time_ns, each.signal_index, each.value, strict=True)
    ]


@dataclass
class Tapped:
    """What a recorder knows of a tap."""

    signals: list[TapSignal] = field(default_factory=lambda: list(SIGNALS))
    url: str = "double:"
    interval_ns: int | None = 10_000_000


def recorder(directory: Path, seal_at: SealAt | None = None, reserve_bytes: int = 0) -> Recorder:
    """A recorder of `SIGNALS`."""
    return Recorder(directory, Tapped(), seal_at=seal_at, reserve_bytes=reserve_bytes)


def record(directory: Path, given: Sequence[Batch], seal_at: SealAt | None = None) -> None:
    """One session, from opening to closing."""
    with recorder(directory, seal_at) as open_recorder:
        for each in given:
            open_recorder.append(each)


def eventually(true: Callable[[], bool], within_s: float = 60.0) -> None:
    """Waits for what another thread does; the limit only guards against hanging."""
    end = time.monotonic() + within_s
    while not true():
        assert time.monotonic() < end, "it never came"
        time.sleep(0.01)


class DoubleTap(Tap):
    """Gives the batches it was given, then ends, or waits to be closed."""

    def __init__(self, given: Sequence[Batch], *, ends: bool = True) -> None:
        self.url = "double:"
        self.signals = list(SIGNALS)
        self.connection = Connection()
        self.interval_ns = 10_000_000
        self._given = given
        self._ends = ends
        self._closed = asyncio.Event()

    async def __aiter__(self) -> AsyncIterator[Batch]:
        self.connection = Connection(ConnectionState.CONNECTED)
        for each in self._given:
            yield each
        if not self._ends:
            await self._closed.wait()

    async def check(self) -> list[Answer]:
        return []

    async def close(self) -> None:
        self._closed.set()
