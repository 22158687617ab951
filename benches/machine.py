"""The machine the numbers are from."""

import os
import platform
import subprocess
from pathlib import Path
from typing import Any

import numpy as np

import runglight


def machine() -> dict[str, Any]:
    """Processor, cores, memory, system, versions and load."""
    return {
        "processor": _line("/proc/cpuinfo", "model name") or platform.processor(),
        "cores": os.cpu_count(),
        "level 2 cache": _cache("index2"),
        "level 3 cache": _cache("index3"),
        "memory_gb": round(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30, 1),
        "system": _system(),
        "kernel": platform.release().partition("-")[0],
        "python": platform.python_version(),
        "numpy": np.__version__,
        "runglight": runglight.__version__,
        "compiler": _first_line("g++", "--version"),
        "load": list(os.getloadavg()),
    }


def _line(path: str, key: str) -> str:
    try:
        lines = Path(path).read_text(encoding="utf-8").splitlines()
    except OSError:
        return ""
    return next((line.partition(":")[2].strip() for line in lines if line.startswith(key)), "")


def _cache(index: str) -> str:
    path = Path("/sys/devices/system/cpu/cpu0/cache") / index / "size"
    return path.read_text(encoding="utf-8").strip() if path.is_file() else ""


def _system() -> str:
    try:
        return platform.freedesktop_os_release().get("PRETTY_NAME", platform.system())
    except OSError:
        return platform.system()


def _first_line(*command: str) -> str:
    try:
        ended = subprocess.run(command, capture_output=True, encoding="utf-8", check=True)
    except (OSError, subprocess.CalledProcessError):
        return ""
    return ended.stdout.partition("\n")[0]
