from runglight.taps.backoff import FIRST_NS, LONGEST_NS, Backoff


def test_waits_double_up_to_the_longest() -> None:
    backoff = Backoff(lambda: 0.5)
    assert [backoff.wait_ns() / 1e9 for _ in range(8)] == [0.1, 0.2, 0.4, 0.8, 1.6, 3.2, 5.0, 5.0]


def test_success_starts_it_over() -> None:
    backoff = Backoff(lambda: 0.5)
    backoff.wait_ns()
    backoff.wait_ns()
    backoff.reset()
    assert backoff.wait_ns() == FIRST_NS


def test_chance_spreads_the_waits() -> None:
    least, most = Backoff(lambda: 0.0), Backoff(lambda: 1.0)
    assert (least.wait_ns(), most.wait_ns()) == (FIRST_NS * 4 // 5, FIRST_NS * 6 // 5)
    for _ in range(20):
        assert most.wait_ns() <= LONGEST_NS
