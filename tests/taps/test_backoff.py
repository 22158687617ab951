from runglight.taps.backoff import Backoff


def test_waits_double_up_to_the_most_and_start_again() -> None:
    backoff = Backoff(0.1, 5.0)
    nominal_s = 0.1
    for _ in range(12):
        assert nominal_s / 2 <= backoff.next_s() <= nominal_s
        nominal_s = min(nominal_s * 2, 5.0)
    assert nominal_s == 5.0
    backoff.reset()
    assert backoff.next_s() <= 0.1


def test_two_taps_do_not_wait_alike() -> None:
    one, other = Backoff(), Backoff()
    assert [one.next_s() for _ in range(8)] != [other.next_s() for _ in range(8)]
