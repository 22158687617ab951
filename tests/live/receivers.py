"""Receivers that behave as a test wants."""

import asyncio
from collections.abc import Sequence

from runglight.findings.store import Kept


class DoubleReceiver:
    """Takes findings; raises `failure` instead while it is set, and hangs while `hanging` is."""

    at_once = 10
    timeout_s = 0.2
    from_the_start = False

    def __init__(self, name: str = "double") -> None:
        self.name = name
        self.taken: list[str] = []
        self.calls = 0
        self.failure: Exception | None = None
        self.hanging = False
        self.closed = False

    async def run(self) -> None:
        """Nothing to do beside delivering."""

    async def deliver(self, findings: Sequence[Kept]) -> None:
        self.calls += 1
        if self.hanging:
            await asyncio.sleep(3600)
        if self.failure is not None:
            raise self.failure
        self.taken += [kept.line for kept in findings]

    async def close(self) -> None:
        self.closed = True
