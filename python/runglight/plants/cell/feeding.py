"""When the next part comes: a pattern of intervals, for so many parts or for ever."""

from collections.abc import Sequence

PART_INTERVALS_S = (30.0, 60.0)

PATTERN_LENGTH = 30
SHORT_PARTS_IN_PATTERN = 7


def mostly_60_s_pattern() -> tuple[float, ...]:
    """Fault 6: thirty intervals in seconds, seven of 30 s spread evenly, the first among them.

    The first part follows no BACKWARD_OFF, so 6 of the 29 transitions are short (0.207), as in
    Table 4.
    """
    step = PATTERN_LENGTH / SHORT_PARTS_IN_PATTERN
    short = {round(number * step) for number in range(SHORT_PARTS_IN_PATTERN)}
    return tuple(30.0 if part in short else 60.0 for part in range(PATTERN_LENGTH))


class PartFeed:
    """How long after the loader stands home and empty each part is set on it.

    The pattern (seconds) is repeated; `parts` is how many come in all, None for no end.
    """

    def __init__(
        self, pattern_s: Sequence[float] = PART_INTERVALS_S, parts: int | None = None
    ) -> None:
        self.parts = parts
        self._pattern_s = tuple(pattern_s)
        self._first = 0

    def interval_s(self, part: int) -> float | None:
        """The interval before a part, counted from 0; None if no more parts come."""
        if part == self.parts:
            return None
        return self._pattern_s[(part - self._first) % len(self._pattern_s)]

    def change(self, pattern_s: Sequence[float], first: int) -> None:
        """From part `first` on, another pattern."""
        self._pattern_s = tuple(pattern_s)
        self._first = first
