"""A log of three signals that begins with all of them."""

import tempfile
from pathlib import Path

from tests.taps.benches.bench import Bench

LOG = """time,signal,value
2026-03-01T06:00:00.000Z,A,0
2026-03-01T06:00:00.000Z,B,0
2026-03-01T06:00:00.000Z,C,7
2026-03-01T06:00:00.010Z,A,1
2026-03-01T06:00:00.020Z,B,1
2026-03-01T06:00:00.020Z,C,8
2026-03-01T06:00:00.350Z,A,0
"""


class ReplayBench(Bench):
    live = False
    polls = False
    signals = ("A", "B", "C")
    changing = "A"

    def __init__(self) -> None:
        self._directory = tempfile.TemporaryDirectory()

    @property
    def url(self) -> str:
        return f"replay:{self._directory.name}/log.csv"

    @property
    def missing_url(self) -> str:
        return f"replay:{self._directory.name}/no-such-log.csv"

    async def start(self) -> None:
        (Path(self._directory.name) / "log.csv").write_text(LOG, encoding="utf-8")

    async def kill(self) -> None:
        self._directory.cleanup()
