import pytest

from runglight.recording.meter import Meter
from tests.recording.doubles import batch


def test_rates_and_jitter_of_regular_scans() -> None:
    meter = Meter(10_000_000)
    assert meter.jitter_p99_ms is None
    assert meter.changes_per_s == meter.scans_per_s == meter.recorded_s == 0
    meter.take(batch(0, [(0, n, 1) for n in range(4)], [0], image=True))
    for number in range(1, 301):
        # One scan in thirty is 3 ms late, and the next one in time again.
        late_s = 0.003 if number % 30 == 0 else 0
        scan_s = number / 100 + late_s
        meter.take(batch(scan_s, [(scan_s, 0, 1)] if number % 2 else [], [scan_s]))
    assert meter.recorded_s == pytest.approx(3, abs=0.01)
    assert meter.scans_per_s == pytest.approx(100, rel=0.01)
    assert meter.changes_per_s == pytest.approx(50, rel=0.01)
    assert meter.jitter_p99_ms == pytest.approx(3)


def test_only_the_last_seconds_count() -> None:
    meter = Meter(None)
    for number in range(100):
        meter.take(batch(number / 10, [(number / 10, 0, 1)] * 5))
    for number in range(10, 30):
        meter.take(batch(number, [(number, 0, 1)]))
    assert meter.recorded_s == pytest.approx(29)
    assert meter.changes_per_s == pytest.approx(1.1)


def test_where_scans_come_as_fast_as_they_can_the_median_is_their_interval() -> None:
    meter = Meter(0)
    meter.take(batch(1, scans_s=[0.1, 0.2, 0.3, 0.4, 0.5]))
    assert meter.jitter_p99_ms == pytest.approx(0, abs=1e-6)
