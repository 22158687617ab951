"""What is searched: a log under the addresses of its PLC, and what else is known of its signals."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from runglight.log.changelog import Log, as_log, read_log_with
from runglight.log.options import ReadOptions
from runglight.log.symbols import names_by_address, read_symbols
from runglight.recording.layout import is_recording

if TYPE_CHECKING:
    from os import PathLike
    from typing import Any

    from runglight.recording.description import RecordedSignal

DEFAULT_NAMING = "{group}-{device}-{signal}"
_NO_WORDS = {"BOOL"}


@dataclass(frozen=True, slots=True)
class Subject:
    """A log, its words, and the names that are known already."""

    log: Log
    words: tuple[str, ...] = ()
    names: Mapping[str, str] = field(default_factory=dict)
    """Name of an address: of a recording's signals, and of the symbol table."""
    types: Mapping[str, str] = field(default_factory=dict)
    """Type of an address, where a recording tells."""


def subject_of(
    source: Log | Any,
    options: ReadOptions | None = None,
    *,
    symbols: str | PathLike[str] | None = None,
    naming: str = DEFAULT_NAMING,
) -> Subject:
    """The subject a log, an Arrow table, or a path (of a log or a recording) is."""
    names: dict[str, str] = {}
    if symbols is not None:
        names = names_by_address(read_symbols(Path(symbols)), naming)
    if not isinstance(source, str | Path):
        return Subject(as_log(source), names=names)
    if is_recording(Path(source)):
        return of_recording(Path(source), names)
    return Subject(read_log_with(source, options or ReadOptions()), names=names)


def of_recording(directory: Path, names: Mapping[str, str]) -> Subject:
    """A recording up to where it ended, its signals called by their addresses again."""
    # Loaded where there is a recording: SQLite and NumPy come with it.
    from runglight.recording.description import read_description  # noqa: PLC0415
    from runglight.recording.read import log_to_its_end  # noqa: PLC0415

    log = log_to_its_end(directory)
    signals = {signal.name: signal for signal in read_description(directory).signals}
    recorded = [signals[name] for name in log.signals]
    addresses = [signal.address or signal.name for signal in recorded]
    if len(set(addresses)) < len(addresses):
        # A Sparkplug metric may have no address of its own.
        addresses = [signal.name for signal in recorded]
    called = dict(zip(addresses, recorded, strict=True))
    return Subject(
        log=log.renamed(addresses) if addresses != log.signals else log,
        words=tuple(address for address, signal in called.items() if _is_word(signal)),
        names={a: s.name for a, s in called.items() if s.name != a} | dict(names),
        types={address: signal.type for address, signal in called.items()},
    )


def _is_word(signal: RecordedSignal) -> bool:
    return signal.type not in _NO_WORDS
