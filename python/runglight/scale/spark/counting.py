"""What a watch has told so far, for a log line or a metric."""

from __future__ import annotations

import logging
from collections import Counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pyspark.sql import DataFrame

_log = logging.getLogger("runglight.scale.spark")


class Counts:
    """Findings told since the start of this process, by kind."""

    def __init__(self) -> None:
        self.by_kind: Counter[str] = Counter()

    def add(self, findings: DataFrame) -> int:
        """Counts the findings of a micro-batch; returns how many there are."""
        rows = findings.groupBy("kind").count().collect()
        told = {str(row["kind"]): int(row["count"]) for row in rows}
        self.by_kind.update(told)
        if told.get("gap"):
            # Late, unreadable or homeless changes: whoever runs the stream should see it as well.
            for row in findings.where("kind = 'gap'").select("finding").take(5):
                _log.warning("%s", row["finding"])
        return sum(told.values())
