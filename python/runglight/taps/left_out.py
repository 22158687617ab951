"""What a tap was sent and did not take, by name, for people."""

LISTED = 200
"""Names kept; a source that invents names for ever must not fill the memory."""


class LeftOut:
    """Names that are left out, each with the reason first seen and how often it was met."""

    def __init__(self) -> None:
        self._reasons: dict[str, str] = {}
        self._times: dict[str, int] = {}
        self._unlisted = 0

    def add(self, name: str, reason: str) -> None:
        """`name` was left out because of `reason`, once more."""
        if name not in self._reasons and len(self._reasons) >= LISTED:
            self._unlisted += 1
            return
        self._reasons.setdefault(name, reason)
        self._times[name] = self._times.get(name, 0) + 1

    def forget(self, name: str) -> None:
        """What was said of `name` no longer holds."""
        self._reasons.pop(name, None)
        self._times.pop(name, None)

    def sentences(self) -> list[str]:
        """One line per name, in the order they were met."""
        lines = [
            f"{name}: {reason}" + (f" ({times} times)" if (times := self._times[name]) > 1 else "")
            for name, reason in self._reasons.items()
        ]
        if self._unlisted:
            lines.append(f"and {self._unlisted} more under further names")
        return lines
