"""Findings as CSV: the keys of the schema as columns, lists as JSON in one cell."""

import csv
import io
import json
from typing import Any

from runglight.findings.schema import KEYS


def header() -> str:
    """The first line."""
    return _line(list(KEYS))


def row(json_line: str) -> str:
    """One finding."""
    finding: dict[str, Any] = json.loads(json_line)
    return _line([_cell(finding.get(key)) for key in KEYS])


def _cell(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, list):
        return json.dumps(value, ensure_ascii=False, separators=(",", ":"))
    return str(value)


def _line(cells: list[str]) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow(cells)
    return text.getvalue()
