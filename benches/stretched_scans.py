"""False alarms of scans that came late: `python -m benches.stretched_scans`.

A sound cell is scanned every 10 ms; once in a log the computer is busy and the next scan comes so
much later, just after something changed. Everything that happened meanwhile then seems to happen at
once. Told as changes, and told as a gap.
"""

from __future__ import annotations

import json
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from runglight.log.changelog import Log
from runglight.model import NominalModel, learn
from runglight.plants import PLANTS, write_symbols

if TYPE_CHECKING:
    import numpy.typing as npt

    from runglight.plants.run import PlantRun

STRETCHES_MS = (30, 100, 150, 200, 300, 500, 900)
PLACES = 150
SCAN_NS = 10_000_000


def main() -> None:
    """Prints one JSON line a stretch."""
    cell = PLANTS["cell"]
    with tempfile.TemporaryDirectory() as name:
        symbols = Path(name) / "symbols.csv"
        write_symbols(cell.symbols, symbols)
        sound = cell.simulate(cycles=20, seed=1)
        log = Log.from_columns(sound.time_ns, sound.signal_index, sound.value, sound.signals)
        model = learn(log, symbols=symbols)
    watched = cell.simulate(cycles=20, seed=7)
    for stretch_ms in STRETCHES_MS:
        random = np.random.default_rng(stretch_ms)
        wrong = {"changes": 0, "gap": 0}
        for _ in range(PLACES):
            at = int(random.integers(100, len(watched.time_ns) - 50))
            start_ns = int(watched.time_ns[at] - random.integers(0, stretch_ms * 1_000_000))
            end_ns = ((start_ns + stretch_ms * 1_000_000) // SCAN_NS + 1) * SCAN_NS
            for told in wrong:
                stretched = _stretched(watched, start_ns, end_ns, as_gap=told == "gap")
                wrong[told] += _alarms(model, stretched) > 0
        print(json.dumps({"stretch_ms": stretch_ms, "of": PLACES, "false_alarms": wrong}))


def _stretched(run: PlantRun, start_ns: int, end_ns: int, *, as_gap: bool) -> Log:
    """The log without scans between two times."""
    time_ns, index, value = map(np.asarray, (run.time_ns, run.signal_index, run.value))
    first = int(np.searchsorted(time_ns, start_ns, "right"))
    last = int(np.searchsorted(time_ns, end_ns, "right"))
    before = _values(index[:first], value[:first])
    after = before | _values(index[first:last], value[first:last])
    seen = after if as_gap else {s: v for s, v in after.items() if before.get(s) != v}
    signals: npt.NDArray[np.uint32] = np.array(sorted(seen), np.uint32)
    return Log.from_columns(
        np.concatenate([time_ns[:first], np.full(len(seen), end_ns), time_ns[last:]]),
        np.concatenate([index[:first], signals, index[last:]]).astype(np.uint32),
        np.concatenate([value[:first], [seen[int(s)] for s in signals], value[last:]]),
        run.signals,
        gaps=[(start_ns, end_ns)] if as_gap else [],
    )


def _values(index: npt.NDArray[np.integer], value: npt.NDArray[np.integer]) -> dict[int, int]:
    return dict(zip(index.tolist(), value.tolist(), strict=True))


def _alarms(model: NominalModel, log: Log) -> int:
    monitor = model.monitor()
    lines = monitor.observe(log).json_lines() + monitor.finish().json_lines()
    return sum(json.loads(line)["severity"] != "notice" for line in lines)


if __name__ == "__main__":
    main()
