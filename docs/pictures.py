"""Takes the pictures of the page: `python -m docs.pictures`.

Needs node, chromium and `npm ci` in web; Pillow, where it is there, makes the files small.
"""

import asyncio
import os
import shutil
import tempfile
from pathlib import Path

from runglight.log.changelog import Log
from runglight.model import learn
from runglight.plants import PLANTS, write_symbols
from tests.server.browser import look
from tests.server.photographed import photographed

INTO = Path(__file__).parent / "images/page"
COLOURS = 256


def main() -> None:
    """Serves the cell, breaks it, and looks at every view."""
    with tempfile.TemporaryDirectory() as name:
        directory = Path(name)
        run = PLANTS["cell"].simulate(cycles=20, seed=1)
        log = Log.from_columns(run.time_ns, run.signal_index, run.value, run.signals)
        log.write(directory / "sound.csv")
        broken = PLANTS["cell"].simulate(seed=2, fault=1)
        Log.from_columns(broken.time_ns, broken.signal_index, broken.value, broken.signals).write(
            directory / "with-fault.csv"
        )
        write_symbols(PLANTS["cell"].symbols, directory / "symbols.csv")
        learn(log, symbols=directory / "symbols.csv").save(directory / "cell.model")
        (directory / "runglight.toml").write_text(
            "[signal_state]\n# What we can bear.\nfalse_alarms_per_day = 1.0\n", encoding="utf-8"
        )
        machine = photographed(directory / "station2")
        declared = [machine.photo_after(time_ns) for time_ns in machine.seen_ns]
        os.environ["BELT"] = ",".join(map(str, declared))
        os.environ["PICTURES"] = str(directory / "pictures")
        seen = asyncio.run(look(directory, "prt-chk-on-while-returning", "shots.mjs"))
        print(seen.errors)
        INTO.mkdir(parents=True, exist_ok=True)
        for picture in sorted((directory / "pictures").glob("*.png")):
            _keep(picture, INTO / picture.name)


def _keep(picture: Path, target: Path) -> None:
    try:
        from PIL import Image  # noqa: PLC0415
    except ModuleNotFoundError:
        shutil.copy(picture, target)
        return
    with Image.open(picture) as image:
        small = image.convert("RGB").quantize(
            COLOURS, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE
        )
        small.save(target, optimize=True)


if __name__ == "__main__":
    main()
