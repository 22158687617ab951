"""The times at which a polled tap scans."""


class Grid:
    """Scans at `start + k · interval`; what was overslept is left out, never made up for."""

    def __init__(self, interval_ns: int) -> None:
        self._interval_ns = interval_ns
        self._slot_ns: int | None = None

    def next_ns(self, now_ns: int) -> int:
        """The next slot after the last one that is not over yet; the first one is now."""
        if self._slot_ns is None or not self._interval_ns:
            self._slot_ns = now_ns
        else:
            intervals = -(-(now_ns - self._slot_ns) // self._interval_ns)
            self._slot_ns += max(intervals, 1) * self._interval_ns
        return self._slot_ns
