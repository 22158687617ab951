"""What a count says of the rate behind it."""

from collections.abc import Callable
from math import exp, lgamma, log


def at_most(count: int, mean: float) -> float:
    """Probability of at most `count` events where `mean` are expected."""
    if mean <= 0:
        return 1.0
    return sum(exp(n * log(mean) - mean - lgamma(n + 1)) for n in range(count + 1))


def upper_bound(count: int, confidence: float = 0.95) -> float:
    """The largest mean that `count` events do not speak against (one-sided, exact).

    >>> round(upper_bound(0), 3), round(upper_bound(3), 3)
    (2.996, 7.754)
    """
    return _where(lambda mean: at_most(count, mean) > 1 - confidence, 4.0 * count + 10)


def lower_bound(count: int, confidence: float = 0.95) -> float:
    """The least mean that `count` events do not speak against (one-sided, exact).

    >>> round(lower_bound(0), 3), round(lower_bound(3), 3)
    (0.0, 0.818)
    """
    if count == 0:
        return 0.0
    return _where(lambda mean: 1 - at_most(count - 1, mean) < 1 - confidence, float(count))


def _where(still_below: Callable[[float], bool], high: float) -> float:
    low = 0.0
    for _ in range(80):
        middle = (low + high) / 2
        low, high = (middle, high) if still_below(middle) else (low, middle)
    return (low + high) / 2
