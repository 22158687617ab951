"""Whoever gives never waits."""

import threading

import pytest

from runglight.live.bounded_worker import BoundedWorker


def test_in_order_and_all_of_it() -> None:
    done: list[int] = []
    worker = BoundedWorker[int]("test", done.append, pytest.fail, at_most=1000)
    for number in range(500):
        worker.put(number)
    assert worker.close(within_s=30)
    assert done == list(range(500))
    assert worker.dropped == 0


def test_the_oldest_go_where_work_is_held_up() -> None:
    begun, go_on = threading.Event(), threading.Event()
    done: list[int] = []

    def work(number: int) -> None:
        begun.set()
        go_on.wait(30)
        done.append(number)

    worker = BoundedWorker[int]("test", work, pytest.fail, at_most=3)
    worker.put(0)
    assert begun.wait(30)
    for number in range(1, 11):
        worker.put(number)
    assert not worker.close(within_s=0.01)
    go_on.set()
    assert worker.close(within_s=30)
    assert done == [0, 8, 9, 10]
    assert worker.dropped == 7


def test_an_error_ends_it_and_is_told() -> None:
    failed: list[Exception] = []

    def work(number: int) -> None:
        raise BrokenPipeError(number)

    worker = BoundedWorker[int]("test", work, failed.append, at_most=3)
    worker.put(1)
    assert worker.close(within_s=30)
    worker.put(2)
    assert [str(error) for error in failed] == ["1"]
