"""Results to standard output, or with `-o FILE` to a file that appears whole."""

from __future__ import annotations

import sys
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from runglight.replacing import replacing

if TYPE_CHECKING:
    from collections.abc import Iterator


@contextmanager
def output(file: Path | str | None, *, keep_when_interrupted: bool = False) -> Iterator[TextIO]:
    """A text stream: standard output for None or `-`, else the file."""
    if file is None or str(file) == "-":
        yield sys.stdout
        return
    with (
        replacing(Path(file), keep_when_interrupted=keep_when_interrupted) as temporary,
        temporary.open("w", encoding="utf-8", newline="") as stream,
    ):
        yield stream
