"""How long to wait before a receiver that took nothing is tried again."""

import random


class Backoff:
    """Waits that double from `first_s` to `most_s`, with jitter.

    Jitter (each wait is between half and all of its nominal length) keeps many watchers of one
    broken server from knocking at the same moment.
    """

    def __init__(self, first_s: float = 0.1, most_s: float = 5.0) -> None:
        self._first_s = first_s
        self._most_s = most_s
        self._nominal_s = first_s

    def next_s(self) -> float:
        """Seconds to wait before the next try."""
        wait_s = self._nominal_s * random.uniform(0.5, 1.0)
        self._nominal_s = min(self._nominal_s * 2, self._most_s)
        return wait_s

    def reset(self) -> None:
        """It was taken: the next loss starts from the shortest wait again."""
        self._nominal_s = self._first_s
