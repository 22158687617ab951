from runglight.taps.source_time import IMPLAUSIBLE_NS, REMEMBERED_NS, SourceTime

MS = 1_000_000
NOW = 1_800_000_000_000_000_000


def test_stamps_of_a_clock_that_agrees_are_taken_as_they_are() -> None:
    times = SourceTime(200 * MS)
    assert times.ours(NOW - 5 * MS, NOW) == NOW - 5 * MS
    assert times.ours(NOW - 150 * MS, NOW + MS) == NOW - 150 * MS


def test_a_late_value_among_prompt_ones_keeps_its_stamp() -> None:
    times = SourceTime(200 * MS)
    times.ours(NOW - MS, NOW)
    assert times.ours(NOW - 900 * MS, NOW + MS) == NOW - 900 * MS


def test_a_clock_that_is_ahead_or_behind_keeps_its_intervals() -> None:
    for offset in (-600_000 * MS, 600_000 * MS):
        times = SourceTime(200 * MS)
        first = times.ours(NOW + offset, NOW + 3 * MS)
        # Sent 50 ms later, held up on the way: the interval of the source counts.
        second = times.ours(NOW + offset + 50 * MS, NOW + 90 * MS)
        assert second - first == 50 * MS
        assert first == NOW + 3 * MS


def test_never_in_our_future() -> None:
    times = SourceTime(200 * MS)
    times.ours(NOW - 600_000 * MS, NOW)
    assert times.ours(NOW + 5 * MS, NOW) <= NOW


def test_a_stamp_of_another_day_is_the_time_of_arrival_and_counted() -> None:
    times = SourceTime(200 * MS)
    for stamp in (0, NOW - IMPLAUSIBLE_NS - 1, NOW + IMPLAUSIBLE_NS + 1, 4 * NOW):
        assert times.ours(stamp, NOW) == NOW
    assert times.implausible == 4
    assert times.ours(NOW - MS, NOW) == NOW - MS


def test_a_drifting_clock_is_followed() -> None:
    times = SourceTime(0)
    for minute in range(30):
        now = NOW + minute * (REMEMBERED_NS + 1)
        stamp = now - 1000 * MS - minute * MS
        assert abs(times.ours(stamp, now) - now) <= 2 * MS
