"""What comes out of the stream: one row per finding, or per change of its state."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import msgspec
import pandas as pd

if TYPE_CHECKING:
    from runglight.scale.spark.part_watcher import Told

SCHEMA = (
    "plant string, id string, state string, time timestamp, kind string, severity string, "
    "finding string, snapshot string"
)
"""`finding` is the JSON of the published schema, `snapshot` that of the snapshot it names.

A row is made once for each `plant`, `id` and `state`: where a sink wrote twice, by them it shows.
"""
COLUMNS = ["plant", "id", "state", "time", "kind", "severity", "finding", "snapshot"]


class _Row(msgspec.Struct, frozen=True):
    id: str
    state: str
    time: str
    kind: str
    severity: str
    snapshot_id: str | None = None


class _Named(msgspec.Struct, frozen=True):
    id: str


_row = msgspec.json.Decoder(_Row)
_named = msgspec.json.Decoder(_Named)


def frame(plant: str, told: Told) -> Any:
    """The findings as a pandas frame of `SCHEMA`."""
    snapshots = {_named.decode(text).id: text for text in told.snapshots}
    rows = [_row.decode(line) for line in told.lines]
    return pd.DataFrame(
        {
            "plant": plant,
            "id": [row.id for row in rows],
            "state": [row.state for row in rows],
            # Spark's timestamps are microseconds; the JSON has them all.
            "time": pd.to_datetime([row.time for row in rows], utc=True, format="ISO8601")
            .tz_localize(None)
            .as_unit("us"),
            "kind": [row.kind for row in rows],
            "severity": [row.severity for row in rows],
            "finding": told.lines,
            "snapshot": [snapshots.get(row.snapshot_id or "") for row in rows],
        },
        columns=COLUMNS,
    )
