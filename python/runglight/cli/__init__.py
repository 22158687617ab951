"""The command line: one file per command."""

from __future__ import annotations

import errno
import gc
import os
import sys
from typing import TYPE_CHECKING

from runglight import environment
from runglight.cli.exit_codes import DONE, INTERRUPTED, WRONG

if TYPE_CHECKING:
    from collections.abc import Sequence


_GARBAGE_AFTER = 50_000
"""Objects made before garbage is looked for: imports make many, and all of them stay."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs `runglight` and returns its exit code. Nothing leaves here as a traceback."""
    _prepare_streams()
    gc.set_threshold(_GARBAGE_AFTER)
    try:
        # Not at the top of the file: an engine that cannot be loaded must end in a sentence too.
        from runglight.cli.application import run  # noqa: PLC0415

        code = run(sys.argv[1:] if arguments is None else list(arguments))
        sys.stdout.flush()
    except KeyboardInterrupt:
        print("runglight: interrupted", file=sys.stderr)
        return INTERRUPTED
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else DONE
    except BaseException as error:  # The engine's own panics are no `Exception`.
        return _failed(error)
    return code


def _prepare_streams() -> None:
    # A service may start us with its streams closed; a terminal may not know an arrow.
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115
        elif hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")


def _usage(error: Exception) -> str:
    text = " ".join(str(error).split())
    return text if text.endswith((".", "?", "!")) else f"{text}."


def _failed(error: BaseException) -> int:
    if isinstance(error, BrokenPipeError):
        # Whoever read our output has seen enough (`runglight … | head`).
        _silence_stdout()
        return DONE
    # Not at the top of the file: what is imported after the threshold above costs no collection.
    from cyclopts import CycloptsError  # noqa: PLC0415

    if isinstance(error, CycloptsError):
        return _complain(f"{_usage(error)} See runglight --help.")
    if environment.debug():
        import traceback  # noqa: PLC0415

        traceback.print_exception(error)
        return WRONG
    return _complain(_sentence(error))


def _sentence(error: BaseException) -> str:
    from runglight.errors import RunglightError  # noqa: PLC0415

    if isinstance(error, RunglightError):
        return str(error)
    if isinstance(error, OSError) and error.errno is not None:
        return _system_sentence(error)
    if isinstance(error, UnicodeEncodeError):
        return f"{error.object!a}: a name that is not UTF-8; rename the file"
    if isinstance(error, MemoryError):
        return "not enough memory; try a shorter log"
    return (
        f"this is a defect of runglight, please report it: {type(error).__name__}: {error} "
        f"({environment.DEBUG}=1 shows where)"
    )


def _system_sentence(error: OSError) -> str:
    place = f"{error.filename}: " if error.filename else ""
    if error.errno in {errno.ENOSPC, errno.EDQUOT}:
        _silence_stdout()
        return f"{place}the disk is full; nothing was replaced, free some space and try again"
    if error.errno in {errno.EACCES, errno.EPERM}:
        return f"{place}permission denied; check the rights of the file or its directory"
    if error.errno == errno.EROFS:
        return f"{place}this disk is read-only; choose another place"
    if error.errno == errno.ENOENT:
        return f"{place}no such file or directory; check the path"
    if error.errno == errno.EISDIR:
        return f"{place}is a directory; name a file"
    return f"{place}{os.strerror(error.errno or 0).lower()}"


def _silence_stdout() -> None:
    # The interpreter flushes standard output once more when it ends; that must not fail again.
    try:
        descriptor = sys.stdout.fileno()
    except (OSError, ValueError):
        return
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, descriptor)
    os.close(null)


def _complain(sentence: str) -> int:
    print(f"runglight: {' '.join(sentence.split())}", file=sys.stderr)
    return WRONG
