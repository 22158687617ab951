"""The published schema of a finding, JSON Schema draft 2020-12."""

import json
from functools import cache
from typing import Any

KEYS = (
    "id",
    "incident",
    "time",
    "kind",
    "severity",
    "state",
    "model",
    "group",
    "device",
    "signal",
    "address",
    "from",
    "to",
    "expected",
    "observed_s",
    "limit_s",
    "rank",
    "suspects",
    "path",
    "snapshot_id",
    "message",
)
"""Every finding has all of these, in this order."""

SEVERITIES = ("fault", "anomaly", "notice")
"""Gravest first."""

CONFIRMABLE_KINDS = ("transition", "alarm_path")
"""Kinds that carry a path the operator may accept into the model."""


@cache
def _schema_text() -> str:
    # Every command would pay for it, and hardly any asks.
    from importlib.resources import files  # noqa: PLC0415

    return (files("runglight.findings") / "finding.schema.json").read_text(encoding="utf-8")


def finding_schema() -> dict[str, Any]:
    """The JSON Schema of one finding, as published with this version."""
    schema: dict[str, Any] = json.loads(_schema_text())
    return schema
