"""Rows on their way from a database to the reader."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from sqlalchemy import Connection

    from runglight.log.options import ReadOptions
    from runglight.log.report import LeftOut


@dataclass(frozen=True)
class Page:
    """Some rows that may be read."""

    cells: list[Sequence[Any]]
    """One cell for each of the source's columns."""
    names: list[str] | None = None
    """What each row is called in the database (`id 17`), where it is called anything."""
    skipped: int = 0
    """Rows that were fetched and are not to be read, because of their quality."""
    unknown: int = 0
    """Rows of tags that the database does not name."""
    timeless: int = 0
    """Rows that have no time."""

    @property
    def left_out(self) -> int:
        """Rows that are not to be read."""
        return self.skipped + self.unknown + self.timeless


class Source(Protocol):
    """A table, or a historian's tables together, as rows in time order."""

    @property
    def shown(self) -> str:
        """What the user is told it is called; without the password."""

    @property
    def columns(self) -> list[str]:
        """The columns a log may be made of."""

    @property
    def bad_quality(self) -> str:
        """Why rows are skipped, in words: `_QUALITY is not 192 (good)`."""

    @property
    def notes(self) -> list[str]:
        """What the user must know of it."""

    @property
    def left_out(self) -> list[LeftOut]:
        """What is not read of it."""

    def reading(self, options: ReadOptions) -> ReadOptions:
        """How the file that the rows are written to is read."""

    def pages(self, connection: Connection) -> Iterator[Page]:
        """All rows, a page at a time."""
