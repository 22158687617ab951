"""The bottling machine recorded with a photo for every scan, and what was to be seen in them."""

import asyncio
import bisect
from dataclasses import dataclass
from pathlib import Path

from benches.bottling_cases import CASES, recorded
from benches.proposed_identification import photograph

SEED = 1
MINUTES = 1.4


@dataclass(frozen=True)
class Photographed:
    """The recording, and when its conveyor started and stopped."""

    path: Path
    seen_ns: list[int]
    photos_ns: list[int]

    def photo_after(self, time_ns: int) -> int:
        """The first photo that shows what happened."""
        return min(bisect.bisect_left(self.photos_ns, time_ns), len(self.photos_ns) - 1)


def photographed(directory: Path) -> Photographed:
    """Recorded over Modbus TCP in simulated time: a second or two of work for a minute."""
    case = CASES["conveyor"]
    made = asyncio.run(recorded(case, SEED, directory, MINUTES))
    photograph(case, SEED, made, directory)
    seen = [sight.time_ns for sight in made.sights if sight.what in case.meaning.seen_as]
    return Photographed(directory, seen, made.scan_ns.tolist())
