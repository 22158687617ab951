"""`runglight check`: which signals of a source answer, and whether the configuration holds."""

from __future__ import annotations

import asyncio
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter
from rich import box
from rich.table import Table
from rich.text import Text

from runglight.cli import terminal
from runglight.cli.counted import counted
from runglight.cli.exit_codes import DONE, WRONG
from runglight.configuration import load_configuration
from runglight.errors import InputError
from runglight.log.symbols import names_by_address, read_symbols
from runglight.model import load_model
from runglight.taps import is_live, open_tap

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from runglight.configuration import Configuration
    from runglight.taps.base import Answer, TapSignal


def check(
    url: str | None = None,
    /,
    *,
    config: Annotated[Path | None, Parameter(name=["--config", "-c"])] = None,
    model: Path | None = None,
) -> int:
    """Say which signals of a machine answer, what they are now, and how long that took.

    Nothing is ever written to the PLC. The symbol table and, with `--model`, the model are looked
    at as well. Ends with code 2 where a signal does not answer.

    Parameters
    ----------
    url: str
        The live address (default: `[source] url` of the configuration).
    config: Path
        Configuration file (default: `runglight.toml`, if there is one).
    model: Path
        Model directory: are its signals among those that answer?

    """
    configuration = load_configuration(config)
    source = url or configuration.source.url
    if source is None:
        raise InputError("what shall be checked? name a live address, or a file with -c")
    if not is_live(source):
        raise InputError(f"{source}: is a log, not a live source; runglight watch reads it")
    name_of, known = _names(configuration, model)
    asked = asyncio.run(_asked(source, configuration.source.interval))
    names = [name_of(answer.signal) for answer in asked.answers]
    console = terminal.results()
    console.print(_table(asked.answers, names))
    silent = [answer for answer in asked.answers if answer.error is not None]
    answering = len(asked.answers) - len(silent)
    console.print(
        Text(
            f"{asked.url}: {answering:,} of {counted(len(asked.answers), 'signal')} answer, "
            f"in {asked.seconds * 1000:.1f} ms"
        ),
        soft_wrap=True,
    )
    for sentence in _about_model(names, known, model):
        terminal.note(sentence)
    if silent or not asked.answers:
        return WRONG
    return DONE


@dataclass(frozen=True)
class Asked:
    """What a source said about itself."""

    url: str
    answers: list[Answer]
    seconds: float


async def _asked(source: str, interval: str | None) -> Asked:
    async with open_tap(source, interval=interval) as tap:
        started = time.perf_counter()
        answers = await tap.check()
        return Asked(tap.url, answers, time.perf_counter() - started)


def ask(source: str) -> Asked:
    """Asks a source which signals it has and what they are now."""
    return asyncio.run(_asked(source, None))


def _names(
    configuration: Configuration, model: Path | None
) -> tuple[Callable[[TapSignal], str], set[str]]:
    if model is not None:
        from runglight.live.signal_names import model_names  # noqa: PLC0415

        nominal = load_model(model)
        return model_names(nominal, configuration.symbols), set(nominal.signals)
    names: dict[str, str] = {}
    if configuration.symbols.table is not None:
        table = read_symbols(Path(configuration.symbols.table))
        names = names_by_address(table, configuration.symbols.naming)
    return lambda signal: names.get(signal.address, signal.name), set()


def _about_model(names: Sequence[str], known: set[str], model: Path | None) -> list[str]:
    if model is None:
        return []
    missing = sorted(known - set(names))
    sentences = []
    if missing:
        sentences.append(
            f"{model}: {counted(len(missing), 'signal')} of the model "
            f"{'is' if len(missing) == 1 else 'are'} not among them: {_some(missing)}"
        )
    if strange := sorted(set(names) - known):
        sentences.append(
            f"{model}: does not know {counted(len(strange), 'signal')}: {_some(strange)}"
        )
    return sentences or [f"{model}: all its signals are there"]


def _some(names: Sequence[str]) -> str:
    rest = len(names) - 5
    return ", ".join(names[:5]) + (f" and {rest:,} more" if rest > 0 else "")


def _table(answers: Sequence[Answer], names: Sequence[str]) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for heading in ("Signal", "Address", "Type", "Class"):
        table.add_column(heading, overflow="fold")
    table.add_column("Now", justify="right")
    table.add_column("", overflow="fold")
    for answer, name in zip(answers, names, strict=True):
        signal = answer.signal
        now = Text("" if answer.value is None else f"{answer.value:,}")
        error = Text(answer.error or "", "red")
        cells = (name, signal.address, signal.type, signal.signal_class)
        table.add_row(*map(Text, cells), now, error)
    return table
