"""Findings copied to a database of the plant's own."""

from __future__ import annotations

import asyncio
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

from sqlalchemy.exc import SQLAlchemyError

from runglight.findings.database_store import DatabaseStore, reason

if TYPE_CHECKING:
    from collections.abc import Sequence

    from runglight.findings.store import Kept


class DatabaseCopy:
    """Everything the store beside the model holds, and what comes; in a thread of its own."""

    at_once = 500
    timeout_s = 15.0
    from_the_start = True

    def __init__(self, url: str) -> None:
        self._store = DatabaseStore(url)
        self.name = self._store.name
        self._thread = ThreadPoolExecutor(1, "database")

    async def run(self) -> None:
        """Nothing to do beside delivering."""

    async def deliver(self, findings: Sequence[Kept]) -> None:
        """Writes findings in one transaction; those that are there already stay once."""
        await asyncio.get_running_loop().run_in_executor(self._thread, self._append, findings)

    async def close(self) -> None:
        """Closes the connections."""
        self._thread.submit(self._store.close)
        self._thread.shutdown(wait=False)

    def _append(self, findings: Sequence[Kept]) -> None:
        try:
            self._store.append(
                [kept.line for kept in findings],
                [kept.snapshot for kept in findings if kept.snapshot is not None],
            )
        except SQLAlchemyError as error:
            raise ConnectionError(reason(error)) from None
