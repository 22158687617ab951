"""Memory of a new process: `python -m benches.memory_of_watching MODEL LOG RESULT.json`."""

import ctypes
import json
import resource
import sys
from pathlib import Path

import runglight as rl

ROWS_AT_ONCE = 1 << 18


def memory_mb() -> float:
    """Memory of data, not of code; what was freed is given back first (where the C library can)."""
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    if trim is not None:
        trim(0)
    status = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
    kilobytes = next(line.split()[1] for line in status if line.startswith("RssAnon"))
    return int(kilobytes) * 1024 / 1e6


def main() -> None:
    """Loads, watches, writes what it took."""
    model_path, log_path, result_path = sys.argv[1:]
    rl.read_log, rl.load_model  # noqa: B018 - loads what they need
    before = memory_mb()
    monitor = rl.load_model(model_path).monitor()
    loaded = memory_mb()
    log = rl.read_log(log_path)
    with_log = memory_mb()
    for offset in range(0, len(log), ROWS_AT_ONCE):
        monitor.observe(log.slice(offset, ROWS_AT_ONCE))
    monitor.finish()
    watched = memory_mb()
    result = {
        "loaded_mb": loaded - before,
        "watching_mb": loaded - before + max(watched - with_log, 0.0),
        "state_bytes": len(monitor.state()),
        "process_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3,
    }
    Path(result_path).write_text(json.dumps(result), encoding="utf-8")


if __name__ == "__main__":
    main()
