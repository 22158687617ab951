"""Days of the press over real S7, in small: recorded, learned, watched, scored as Table 3."""

import asyncio
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import pytest

from benches import press_days, press_s7
from benches.press_scoring import learned, scored, watched
from runglight.findings.finding import decode_finding
from runglight.live.batch_watcher import BatchWatcher
from runglight.plants.press import SYMBOLS, RunningPress
from runglight.plants.press.simulate import START_NS
from runglight.taps.base import Batch, Tap

STOPS = ("curtain", "stop button", "door")
FAILURES = (1, 8, 19)


def test_failures_and_stops_over_s7(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(press_days, "FOLDER", tmp_path)
    nominal = press_s7.recorded("nominal", interval_ms=150, seed=1, cycles=100, normal=STOPS * 3)
    model = learned(nominal.log, "element")
    live: list[str] = []
    watchers: list[BatchWatcher] = []

    def watch(tap: Tap) -> Callable[[Batch], None]:
        watcher = BatchWatcher(
            model,  # type: ignore[arg-type]
            model.monitor(),
            tap.signals,
            lambda signal: signal.name,
        )
        watchers.append(watcher)
        return lambda batch: live.extend(watcher.take(batch))

    days = press_s7.recorded(
        "days",
        interval_ms=150,
        seed=2,
        cycles=60,
        failures=FAILURES,
        normal=(*STOPS, "manual", "cycle stop"),
        listen=watch,
    )
    live += watchers[0].complete()
    findings = watched(model, days.log)
    assert [decode_finding(line) for line in live] == findings
    assert nominal.cycles == 100
    assert not nominal.log.engine.gaps, "a leap of the clock must never look like a lost connection"
    assert {address.address for address in SYMBOLS[:216]} <= set(nominal.log.signals)
    found = scored(days, findings)
    # A hundred cycles are few: where two wait, which comes first is not sure yet.
    assert found.true_positive >= 2
    assert found.true_positive + found.false_negative == len(FAILURES)
    # Learned stops are no failures. The cycle stop was never learned: nobody can know it is none.
    assert (found.false_positive, found.true_negative) == (1, 4)
    word = scored(days, watched(learned(nominal.log, "word"), days.log))
    assert (word.false_positive, word.true_negative) == (1, 4)


def test_the_clock_leaps_only_while_nothing_happens() -> None:
    press = RunningPress(START_NS)
    clock = press_s7.ScanClock(press, 150_000_000, lambda: None)

    async def scan(until_ns: int) -> list[int]:
        times = []
        while clock.time_ns < until_ns:
            await clock.sleep_until(clock.time_ns + clock.interval_ns)
            press.advance(clock.time_ns)
            times.append(clock.time_ns)
        return times

    changed: list[int] = []
    press.advance(START_NS)
    press.on_change(lambda time_ns, _number, _value: changed.append(time_ns))
    times = asyncio.run(scan(START_NS + 120 * 10**9))
    steps = [after - before for before, after in pairwise(times)]
    assert {step % clock.interval_ns for step in steps} == {0}
    assert max(steps) < 10**9
    assert len(times) < 0.6 * 120 / 0.15
    # Every change is seen by the first scan of the grid after it.
    for change in changed:
        assert next(time for time in times if time >= change) - change < clock.interval_ns
