"""The small C programs beside the benches, built when needed."""

import ctypes
import subprocess
from pathlib import Path

FOLDER = Path(__file__).parent / "c"


def library(name: str) -> ctypes.CDLL:
    """Builds and loads one of them."""
    subprocess.run(["make", "-s", "-C", FOLDER, f"build/{name}.so"], check=True)
    return ctypes.CDLL(str(FOLDER / "build" / f"{name}.so"))
