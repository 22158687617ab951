"""The on-delay timer of PLC programs."""


class OnDelay:
    """TON (IEC 61131-3, standard function blocks): true once its input was true for `preset_ns`."""

    def __init__(self, preset_ns: int) -> None:
        self._preset_ns = preset_ns
        self.started_ns: int | None = None

    def __call__(self, signal: bool, now_ns: int) -> bool:
        """One call per scan; a false input resets the timer."""
        if not signal:
            self.started_ns = None
            return False
        if self.started_ns is None:
            self.started_ns = now_ns
        return now_ns - self.started_ns >= self._preset_ns

    @property
    def due_ns(self) -> int | None:
        """When it ends; None while it does not run."""
        return None if self.started_ns is None else self.started_ns + self._preset_ns
