"""SVG of a model, drawn by a Graphviz program that runs beside us (docs/decisions/0001)."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

from runglight.errors import InputError

DRAWING_LIMIT_S = 120


def graphviz_program() -> str | None:
    """The program that draws: `dot`, else `graphviz-pure`, on PATH or beside this Python."""
    found = shutil.which("dot") or shutil.which("graphviz-pure")
    if found is not None:
        return found
    beside = Path(sys.executable).parent / "graphviz-pure"
    return str(beside) if beside.is_file() else None


def draw_svg(dot: str) -> str:
    """The SVG of a Graphviz text."""
    program = graphviz_program()
    if program is None:
        raise InputError(
            "drawing SVG needs Graphviz: apt install graphviz, "
            'or pip install "runglight[svg]"; --format dot works without'
        )
    try:
        drawn = subprocess.run(
            [program, "-Tsvg"],
            input=dot.encode(),
            capture_output=True,
            timeout=DRAWING_LIMIT_S,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise InputError(
            f"{program} did not finish within {DRAWING_LIMIT_S} s; "
            "draw one device instead (--device), or use --format dot"
        ) from None
    if drawn.returncode != 0:
        reason = drawn.stderr.decode(errors="replace").strip().splitlines()
        raise InputError(f"{program} could not draw the model: {reason[-1] if reason else '?'}")
    return drawn.stdout.decode()
