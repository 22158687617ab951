"""The seam of findings stores: the SQLite file beside the model, and databases of one's own."""

from collections.abc import Iterable
from typing import Protocol


class Store(Protocol):
    """Lines of findings in the order they were made; a change of state is a further line."""

    def append(self, json_lines: Iterable[str], snapshots: Iterable[str] = ()) -> None:
        """Writes findings and snapshots in one transaction; what is there already stays once."""

    def newest(self, finding_id: str) -> str | None:
        """The newest line of a finding, or None where the id is not known."""

    def snapshot(self, snapshot_id: str) -> str | None:
        """A snapshot's JSON."""

    def nearest_ids(self, finding_id: str) -> list[str]:
        """The ids that resemble one that is not known; else the latest ones."""

    def close(self) -> None:
        """Lets go of the store. May be called twice."""
