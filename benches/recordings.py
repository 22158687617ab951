"""Real recordings, read where they lie and never copied."""

import os
from pathlib import Path

import runglight as rl

PLACE = "RUNGLIGHT_DATA"
"""Environment variable that names the folder of recordings; else `../shared/data`."""

PATTERNS = (
    "vps_filling/Filling_ALL.module.csv",
    "vps_filling/Filling_C*.csv",
    "vps_filling/Filling_Pump.module.csv",
    "vps_filling/[!F]*.csv",
    "smartfactory_owl_conveyor/log*.csv",
    "atspm_signal/sample_raw_data.csv",
)


def folder() -> Path:
    """Where the recordings are."""
    beside = Path(__file__).parents[2] / "shared" / "data"
    return Path(os.environ.get(PLACE) or beside)


def recordings() -> dict[str, Path]:
    """Name and file of each recording that is there."""
    found = [path for pattern in PATTERNS for path in sorted(folder().glob(pattern))]
    return {_name(path): path for path in found}


def read(path: Path) -> rl.Log:
    """Reads one."""
    return rl.read_log(path)


def _name(path: Path) -> str:
    """`vps_filling/Pump`."""
    stem = path.name.partition(".")[0]
    return f"{path.parent.name}/{stem}"
