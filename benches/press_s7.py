"""The press polled over real S7: `python -m benches.press_s7 [--only PART ...]`.

The press is served by the soft PLC and polled by the S7 tap; its clock goes on with each scan.
While nothing moves it goes on by several intervals at once, but never by so much that a scan would
be missing. Recordings are kept in `benches/results/press`; `python -m benches.cycle --only s7`
learns from them and watches them.
"""

import argparse
import asyncio
import random
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from benches import press_days
from benches.press_days import Days, Plan, with_truth, write_truth
from runglight.plants.agenda import NS_PER_S, nanoseconds
from runglight.plants.press import FAULTS, RunningPress
from runglight.plants.press.simulate import START_NS
from runglight.recording.read import log_to_its_end
from runglight.recording.recorder import Recorder
from runglight.softplc import serve
from runglight.taps import open_tap
from runglight.taps.base import Batch, Tap
from runglight.taps.polled import PolledTap

LEAP_NS = nanoseconds(0.9)
"""Longest time from scan to scan: with more than a second the tap would tell of a gap."""

BURST_SHARE = 0.05
BURST_FACTOR = 8
"""In one of twenty minutes the poller is overloaded, and every scan takes eight times as long."""

OTHERS_TURN = 100
"""Scans after which other tasks have their turn."""

INTERVALS_MS = (10, 50, 150)
SHORT_CYCLES = 400
SHORT_DAYS = 1.0


@dataclass
class ScanClock:
    """The time of a served press: a scan's interval at a time, in leaps while it stands still."""

    press: RunningPress
    interval_ns: int
    next_ns: Callable[[], int | None]
    bursts: bool = False
    time_ns: int = START_NS
    scans: int = 0

    def now_ns(self) -> int:
        """The time now."""
        return self.time_ns

    def take_step_ns(self) -> None:
        """Nobody sets this clock."""

    async def sleep_until(self, time_ns: int) -> None:
        """Returns at once; so much later where the poller is overloaded or the press stands."""
        self.scans += 1
        # After a leap the tap takes the next slot of its grid to be now: that was the last scan.
        time_ns = max(time_ns, self.time_ns + self.interval_ns)
        if self.bursts and self._overloaded():
            time_ns += (BURST_FACTOR - 1) * self.interval_ns
        else:
            time_ns += self._leap_ns(time_ns)
        self.time_ns = time_ns
        if not self.scans % OTHERS_TURN:
            await asyncio.sleep(0)

    def _overloaded(self) -> bool:
        minute = (self.time_ns - START_NS) // (60 * NS_PER_S)
        return random.Random(f"{minute}/burst").random() < BURST_SHARE

    def _leap_ns(self, time_ns: int) -> int:
        """Whole intervals after `time_ns` until just before a scan that could see something.

        A leap up to that scan would be a stretch without scans, with changes at its end: a gap.
        """
        due = [due for due in (self.press.next_change_ns(), self.next_ns()) if due is not None]
        until_ns = min([*due, self.time_ns + LEAP_NS])
        until_ns = min(until_ns, self.time_ns + LEAP_NS)
        return max(-(-(until_ns - time_ns) // self.interval_ns) - 1, 0) * self.interval_ns


Listen = Callable[[Tap], Callable[[Batch], object]]


async def record(
    name: str,
    *,
    interval_ms: int,
    seed: int,
    bursts: bool = False,
    listen: Listen | None = None,
    **what: Any,
) -> None:
    """Records a stretch of operation through the tap; `what` is a `Plan`'s.

    `listen` gives who takes each batch besides the recorder.
    """
    press = RunningPress(START_NS, seed)
    plan = Plan(press, seed=seed, **what)
    clock = ScanClock(press, interval_ms * 1_000_000, lambda: plan.next_ns, bursts)
    began_s = time.monotonic()
    directory = press_days.FOLDER / name
    async with serve(press, "s7://127.0.0.1:0", clock) as plc:
        # Inputs and mode bits, as the paper reads them.
        port = plc.url.port
        url = f"s7://127.0.0.1:{port}?pe=0-26&mk=0&interval={interval_ms}ms"
        tap = open_tap(url, clock=clock)
        # The PLC answers in threads of its own, so that reading may block this one.
        assert isinstance(tap, PolledTap)
        tap.device = partial(tap.device, own_thread=True)  # type: ignore[method-assign]
        async with tap:
            with Recorder(directory, tap) as recorder:
                hear = listen(tap) if listen else None
                async for batch in tap:
                    recorder.append(batch)
                    if hear is not None:
                        hear(batch)
                    if not plan.follow(clock.time_ns):
                        break
    write_truth(truth_of(directory), plan.happenings(), clock.time_ns, press.cycles)
    took_s = time.monotonic() - began_s
    print(
        f"{name}: {press.cycles:,} cycles in {clock.scans:,} scans over S7, {took_s:,.0f} s "
        f"({clock.scans / took_s:,.0f} scans/s)",
        flush=True,
    )


def truth_of(directory: Path) -> Path:
    """What happened, beside the recording."""
    return directory.with_suffix(".json")


def recorded(name: str, **what: Any) -> Days:
    """The recording of a stretch, made where it is missing."""
    directory = press_days.FOLDER / name
    if not truth_of(directory).is_file():
        directory.parent.mkdir(parents=True, exist_ok=True)
        asyncio.run(record(name, **what))
    return with_truth(log_to_its_end(directory), truth_of(directory))


def learned_from() -> Days:
    """7,000 cycles at the paper's 0.15 s."""
    return recorded(
        "s7-learned",
        interval_ms=150,
        seed=1,
        cycles=7_000,
        failures=press_days.LEARNED_FAILURES,
        normal=press_days.LEARNED_STOPS,
    )


HALVES = {"a": (31, slice(0, None, 2)), "b": (32, slice(1, None, 2))}
"""Fifteen days are recorded in two halves, so that two can be recorded at a time: seed, and which
of the failures and of the stops and variations."""


def half(name: str) -> Days:
    """Seven and a half days with 12 failures and 27 stops and variations, at the paper's 0.15 s."""
    seed, which = HALVES[name]
    return recorded(
        f"s7-half-{name}",
        interval_ms=150,
        seed=seed,
        days=7.5,
        failures=tuple(FAULTS)[which],
        normal=press_days.NORMAL[which],
    )


def learned_at(interval_ms: int) -> Days:
    """Four hundred cycles at an interval."""
    return recorded(
        f"s7-learned-{interval_ms}ms",
        interval_ms=interval_ms,
        seed=1,
        cycles=SHORT_CYCLES,
        normal=press_days.LEARNED_STOPS,
    )


def short_days_at(interval_ms: int, *, bursts: bool) -> Days:
    """A day with 24 failures and 27 stops and variations, with or without bursts of overload."""
    name = f"s7-short-days-{interval_ms}ms" + ("-bursts" if bursts else "")
    return recorded(
        name,
        interval_ms=interval_ms,
        seed=press_days.WORKED_OUT_ON,
        bursts=bursts,
        days=SHORT_DAYS,
        failures=tuple(FAULTS),
        normal=press_days.NORMAL[::2],
    )


def all_intervals() -> None:
    """Everything that the table of intervals needs."""
    for interval_ms in reversed(INTERVALS_MS):
        learned_at(interval_ms)
        for bursts in (False, True):
            short_days_at(interval_ms, bursts=bursts)


PARTS: dict[str, Callable[[], object]] = {
    "learned": learned_from,
    "half_a": lambda: half("a"),
    "half_b": lambda: half("b"),
    "intervals": all_intervals,
}


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--only", nargs="+", choices=list(PARTS), default=list(PARTS))
    for name in parser.parse_args().only:
        PARTS[name]()


if __name__ == "__main__":
    main()
