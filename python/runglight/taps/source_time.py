"""Time stamps of a source in our own time.

The source's clock and ours differ. Its stamps are still worth more than the moment a value arrives
here, because the network and the server's publishing interval blur that. So:

- A stamp at most `tolerated_ns` old, and not in our future, is taken as it is.
- Otherwise the clocks differ. The least delay between stamp and arrival seen lately is how far
  (nothing arrives before it was sent, and some value always travels fast): all stamps are moved by
  it, and the times between values stay those of the source. A single late value does not look like
  a difference of clocks, since others arrive with less delay.
- A stamp further than `IMPLAUSIBLE_NS` from ours is no time of this moment (a clock never set,
  local time sent as UTC): the value is stamped on arrival.
"""

IMPLAUSIBLE_NS = 3_600_000_000_000
REMEMBERED_NS = 60_000_000_000
"""The least delay is that of one to two of these spans, so that drifting clocks are followed."""


class SourceTime:
    """One source clock, seen from ours."""

    def __init__(self, tolerated_ns: int) -> None:
        self._tolerated_ns = tolerated_ns
        self._least_ns: int | None = None
        self._least_before_ns: int | None = None
        self._since_ns = 0
        self.implausible = 0
        """Stamps that were no time of this moment."""

    def ours(self, stamp_ns: int, arrived_ns: int) -> int:
        """Our time of what the source stamped `stamp_ns`; never later than `arrived_ns`."""
        delay_ns = arrived_ns - stamp_ns
        if abs(delay_ns) > IMPLAUSIBLE_NS:
            self.implausible += 1
            return arrived_ns
        return min(stamp_ns + self._move_ns(delay_ns, arrived_ns), arrived_ns)

    def _move_ns(self, delay_ns: int, now_ns: int) -> int:
        if self._least_ns is None or now_ns - self._since_ns > REMEMBERED_NS:
            self._least_before_ns, self._least_ns = self._least_ns, delay_ns
            self._since_ns = now_ns
        self._least_ns = min(self._least_ns, delay_ns)
        least_ns = self._least_ns
        if self._least_before_ns is not None:
            least_ns = min(least_ns, self._least_before_ns)
        return 0 if 0 <= least_ns <= self._tolerated_ns else least_ns
