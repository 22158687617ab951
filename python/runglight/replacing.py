"""Files that appear whole or not at all: written to a temporary name, then renamed."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def replacing(target: Path, *, keep_when_interrupted: bool = False) -> Iterator[Path]:
    """Gives a path to write to; it takes the name `target` when the block ends well.

    Where `target` is a device or a pipe (`/dev/stdout`), that itself is written to.
    `keep_when_interrupted` keeps what was written when the user presses Ctrl-C.
    """
    if target.exists() and not target.is_file() and not target.is_dir():
        yield target
        return
    if target.is_dir():
        raise IsADirectoryError(21, "Is a directory", str(target))
    # A link stays a link; what it points to is replaced.
    target = Path(os.path.realpath(target))
    # The ending is kept, so that a writer that goes by it is not misled.
    temporary = target.with_name(f".{target.stem}.{os.urandom(4).hex()}{target.suffix}")
    try:
        yield temporary
    except KeyboardInterrupt:
        if keep_when_interrupted and temporary.exists():
            temporary.replace(target)
        raise
    else:
        temporary.replace(target)
    finally:
        temporary.unlink(missing_ok=True)
