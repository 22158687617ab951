"""What watching needs: `python -m benches.memory_of_watching MODEL LOG RESULT.json`, in a new process."""

import ctypes
import json
import os
import resource
import sys
from pathlib import Path

import runglight as rl

ROWS_AT_ONCE = 1 << 18


def resident_mb() -> float:
    """Resident memory, what was freed given back first (where the C library can)."""
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    if trim is not None:
        trim(0)
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def main() -> None:
    """Loads, watches, writes what it took."""
    model_path, log_path, result_path = sys.argv[1:]
    # Touch what any model would: code and tables that do not grow with the plant.
    rl.Log, rl.NominalModel, rl.load_model, rl.read_log  # noqa: B018
    before = resident_mb()
    monitor = rl.load_model(model_path).monitor()
    loaded = resident_mb()
    log = rl.read_log(log_path)
    with_log = resident_mb()
    for offset in range(0, len(log), ROWS_AT_ONCE):
        monitor.observe(log.slice(offset, ROWS_AT_ONCE))
    monitor.finish()
    watched = resident_mb()
    result = {
        "loaded_mb": loaded - before,
        "watching_mb": loaded - before + max(watched - with_log, 0.0),
        "state_bytes": len(monitor.state()),
        "process_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3,
    }
    Path(result_path).write_text(json.dumps(result), encoding="utf-8")


if __name__ == "__main__":
    main()
