"""Findings on their way to one receiver: tried until they are taken, in order."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Protocol

from runglight.taps.backoff import Backoff

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from runglight.findings.store import Kept
    from runglight.live.keeper import Keeper

LONGEST_WAIT_NS = 30_000_000_000
"""Between two tries to reach a receiver."""


class RefusedError(Exception):
    """The receiver will never take this; it is left out. The text says why."""


class Receiver(Protocol):
    """Whoever is given findings: a broker, a webhook, another database."""

    name: str
    """What people know it by, without secrets; also the key its progress is kept under."""
    at_once: int
    """Findings it is given in one call."""
    timeout_s: float
    """How long one call may take."""

    from_the_start: bool
    """Whether a new receiver is given what was found before it was named."""

    async def run(self) -> None:
        """Works beside `deliver` until cancelled; may end at once."""

    async def deliver(self, findings: Sequence[Kept]) -> None:
        """Hands findings over, in order; what was given before may come again.

        Raises RefusedError for what can never be taken, any other exception to be tried again.
        Being cancelled must leave it usable.
        """

    async def close(self) -> None:
        """Lets go of the receiver."""


class Delivery:
    """Gives one receiver what the store holds, from where it stopped; slow ones delay nobody."""

    def __init__(self, receiver: Receiver, keeper: Keeper, say: Callable[[str], None]) -> None:
        self.receiver = receiver
        self._keeper = keeper
        self._say = say
        self._backoff = Backoff(longest_ns=LONGEST_WAIT_NS)
        self.delivered = 0
        self.refused = 0
        self._giving: asyncio.Task[bool] | None = None
        self.failing: str | None = None
        """One sentence while the receiver takes nothing."""

    async def run(self) -> None:
        """Delivers until cancelled; what is under way then goes on until `finish`."""
        while True:
            findings = await self._next()
            self._giving = asyncio.create_task(self._give(findings))
            if not await asyncio.shield(self._giving):
                await asyncio.sleep(self._backoff.wait_ns() / 1e9)

    async def finish(self, within_s: float) -> None:
        """A last try for what is left; the rest is delivered by the next start."""
        try:
            async with asyncio.timeout(within_s):
                if self._giving is not None:
                    await self._giving
                while self.failing is None and await self._keeper.behind(self.receiver.name):
                    await self._give(await self._next())
        except TimeoutError:
            pass
        if left := await self._keeper.behind(self.receiver.name):
            self._say(f"{self.receiver.name}: {left:,} findings wait for the next start")

    async def _next(self) -> list[Kept]:
        return await self._keeper.next(self.receiver.name, self.receiver.at_once)

    async def _give(self, findings: Sequence[Kept]) -> bool:
        taken = await self._taken(findings)
        if taken:
            await self._keeper.delivered(self.receiver.name, findings[-1].sequence)
        return taken

    async def _taken(self, findings: Sequence[Kept]) -> bool:
        try:
            async with asyncio.timeout(self.receiver.timeout_s):
                await self.receiver.deliver(findings)
        except RefusedError as refusal:
            self.refused += len(findings)
            self._say(f"{self.receiver.name}: a finding was refused and is left out: {refusal}")
        except Exception as error:  # Whatever a library raises, watching goes on.
            self._fail(error)
            return False
        else:
            self.delivered += len(findings)
        if self.failing is not None:
            self._say(f"{self.receiver.name}: takes findings again; it is given what it missed")
        self.failing = None
        self._backoff.reset()
        return True

    def _fail(self, error: Exception) -> None:
        if isinstance(error, TimeoutError):
            reason = f"no answer within {self.receiver.timeout_s:g} s"
        else:
            reason = (str(error).strip() or type(error).__name__).splitlines()[0]
        if self.failing is None:
            self._say(
                f"{self.receiver.name}: takes no findings ({reason}); they are kept and given "
                "when it does"
            )
        self.failing = reason
