"""What identification searches of a recording or log: read once, kept while its page is open."""

from __future__ import annotations

import asyncio
import dataclasses
from collections import OrderedDict
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from runglight import _engine
from runglight.identification.subject import Subject, subject_of
from runglight.log.changelog import Log
from runglight.log.symbols import names_by_address, read_symbols
from runglight.server.diagrams import Diagram, changed_at

if TYPE_CHECKING:
    from pathlib import Path

    from runglight.log.options import ReadOptions
    from runglight.server.catalogue import Item

KEPT = 2


@dataclasses.dataclass(frozen=True)
class Searched:
    """A subject, and its diagram once somebody looks at a candidate."""

    subject: Subject

    def named(self, table: Path, naming: str) -> Subject:
        """With the names of the symbol table as it is now."""
        if not table.is_file():
            return self.subject
        names = names_by_address(read_symbols(table), naming)
        return dataclasses.replace(self.subject, names=dict(self.subject.names) | names)

    def diagram(self) -> Diagram:
        """Every signal and every bit of every word, under the addresses of the ranking."""
        return self._diagram

    @cached_property
    def _diagram(self) -> Diagram:
        log = with_bits(self.subject.log, self.subject.words)
        engine = log.engine
        return Diagram(
            diagram=_engine.TimingDiagram(engine),
            signals=log.signals,
            start_ns=engine.start_ns or 0,
            until_ns=engine.end_ns or 0,
            gaps=engine.gaps,
            rows=len(log),
            addresses={name: name for name in log.signals},
        )


class Subjects:
    """Subjects by item; reading happens in threads."""

    def __init__(self, options: ReadOptions) -> None:
        self._options = options
        self._kept: OrderedDict[tuple[str, float], Searched] = OrderedDict()
        self._reading = asyncio.Lock()

    async def of(self, item: Item) -> Searched:
        """The subject of a recording or a log; InputError where it cannot be read."""
        key = (item.id, changed_at(item.path))
        async with self._reading:
            if key not in self._kept:
                subject = await asyncio.to_thread(subject_of, item.path, self._options)
                for older in [each for each in self._kept if each[0] == item.id]:
                    del self._kept[older]
                self._kept[key] = Searched(subject)
            self._kept.move_to_end(key)
            while len(self._kept) > KEPT:
                self._kept.popitem(last=False)
            return self._kept[key]


def with_bits(log: Log, words: tuple[str, ...]) -> Log:
    """A log with the bits of its words beside the words themselves."""
    time_ns, index, value = log.columns()
    beyond = np.unique(index[(value < 0) | (value > 1)]).tolist()
    numbers = {log.signals.index(word) for word in words if word in log.signals} | set(beyond)
    if not numbers:
        return log
    named = [log.signals[number] for number in sorted(numbers)]
    split = log.split_words(named)
    bit_time_ns, bit_index, bit_value = split.columns()
    of_words = np.isin(index, sorted(numbers))
    places = np.zeros(len(log.signals), np.uint32)
    places[sorted(numbers)] = len(split.signals) + np.arange(len(named), dtype=np.uint32)
    all_ns = np.concatenate([bit_time_ns, time_ns[of_words]])
    all_index = np.concatenate([bit_index, places[index[of_words]]]).astype(np.uint32)
    all_values = np.concatenate([bit_value, value[of_words]])
    order = np.argsort(all_ns, kind="stable")
    return Log.from_columns(
        all_ns[order],
        all_index[order],
        all_values[order],
        [*split.signals, *named],
        log.scan_interval_s,
        gaps=log.engine.gaps,
    )
