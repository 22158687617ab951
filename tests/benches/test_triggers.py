"""Learned triggers against true ones (`benches.triggers`)."""

import pytest

from benches.triggers import judged


@pytest.mark.parametrize(
    ("true", "learned", "answer"),
    [("A", "", "none"), ("A", "A", "exact"), ("AB", "BA", "exact"), ("AB", "A", "half"),
     ("A", "B", "other"), ("A", "AB", "other"), ("AB", "AC", "other")],
)  # fmt: skip
def test_a_wait_is_judged(true: str, learned: str, answer: str) -> None:
    assert judged(frozenset(true), frozenset(learned)) == answer
