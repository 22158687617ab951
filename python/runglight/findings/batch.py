"""Findings in the order they were made."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterator

    from runglight import _engine


class Told(NamedTuple):
    """Findings in words, and what is counted of them: four lists of one length."""

    lines: list[str]
    """JSON, as the published schema describes it."""
    ids: list[str]
    kinds: list[str]
    severities: list[str]


class Findings:
    """What a monitor gives back: iterate it for dictionaries, or hand it to an Arrow library."""

    def __init__(self, engine_findings: _engine.Findings) -> None:
        self._engine = engine_findings

    def __len__(self) -> int:
        return len(self._engine)

    def __iter__(self) -> Iterator[dict[str, Any]]:
        return (json.loads(line) for line in self.json_lines())

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        return self._engine.__arrow_c_stream__(requested_schema)

    def __repr__(self) -> str:
        return f"<runglight.Findings: {len(self)}>"

    def json_lines(self) -> list[str]:
        """One JSON text per finding, as the published schema describes it."""
        return self._engine.json_lines()

    def told(self) -> Told:
        """The JSON of each, with its id, kind and severity."""
        return Told(*self._engine.told())
