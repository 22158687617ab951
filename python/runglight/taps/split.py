"""A tap some of whose words come as bits: `%MW74` as `%MW74.0` to `%MW74.15`."""

from collections.abc import AsyncIterator, Collection
from dataclasses import replace

import numpy as np

from runglight import _engine
from runglight.errors import InputError
from runglight.nearest import suggestion
from runglight.taps.base import Answer, Batch, Connection, Tap, TapSignal

_WIDTHS = {"SINT": 8, "USINT": 8, "BYTE": 8, "DINT": 32, "UDINT": 32, "DWORD": 32}
_LONG = {"LINT": 64, "ULINT": 64, "LWORD": 64}
_WORD = 16


class SplitTap(Tap):
    """Another tap, its words `words` (addresses or names) split into bits; see `Log.split_words`.

    An image tells all bits, any other row those that changed. Raises InputError where a tap that
    knows its signals has no such word.
    """

    def __init__(self, tap: Tap, words: Collection[str]) -> None:
        self._tap = tap
        self._words = frozenset(words)
        self._signals: list[TapSignal] = []
        self._places: list[int] = []
        """For each signal of the tap, the index of its first signal here."""
        self._width: list[int] = []
        """For each signal of the tap its bits; 0 for one that stays whole."""
        self._last: dict[int, int] = {}
        self.url = tap.url
        self.interval_ns = tap.interval_ns

    @property
    def signals(self) -> list[TapSignal]:  # type: ignore[override]
        """The signals, as many as the tap has by now."""
        for signal in self._tap.signals[len(self._places) :]:
            self._places.append(len(self._signals))
            if not self._words & {signal.name, signal.address}:
                self._width.append(0)
                self._signals.append(signal)
                continue
            width = (_WIDTHS | _LONG).get(signal.type, _WORD)
            self._width.append(width)
            self._signals += self._bits(signal, width)
        return self._signals

    @property
    def connection(self) -> Connection:  # type: ignore[override]
        """The tap's connection."""
        return self._tap.connection

    async def __aiter__(self) -> AsyncIterator[Batch]:
        """The tap's batches, a row of a word as rows of its bits."""
        async for batch in self._tap:
            yield self._split(batch)

    async def check(self) -> list[Answer]:
        """The tap's answers: words as they are."""
        return await self._tap.check()

    async def close(self) -> None:
        """Closes the tap."""
        await self._tap.close()

    async def __aenter__(self) -> "SplitTap":
        await self._tap.__aenter__()
        known = {name for each in self._tap.signals for name in (each.name, each.address)}
        missing = next((word for word in sorted(self._words) if word not in known), None)
        if known and missing is not None:
            raise InputError(
                f"bits: {self.url} has no signal {missing!r}{suggestion(missing, known)}"
            )
        return self

    def _bits(self, word: TapSignal, width: int) -> list[TapSignal]:
        signals = [each.address for each in self._tap.signals]
        bits = _engine.bit_names(signals, word.address, width)
        return [
            replace(word, name=bit, address=bit, type="BOOL", description=f"bit of {word.address}")
            for bit in bits
        ]

    def _split(self, batch: Batch) -> Batch:
        _ = self.signals
        times: list[int] = []
        indices: list[int] = []
        values: list[int] = []
        columns = (batch.time_ns.tolist(), batch.signal_index.tolist(), batch.value.tolist())
        for time_ns, index, value in zip(*columns, strict=True):
            first, width = self._places[index], self._width[index]
            if not width:
                times.append(time_ns)
                indices.append(first)
                values.append(value)
                continue
            before = None if batch.image else self._last.get(index)
            self._last[index] = value
            changed = -1 if before is None else before ^ value
            for bit in range(width):
                if changed >> bit & 1:
                    times.append(time_ns)
                    indices.append(first + bit)
                    values.append(value >> bit & 1)
        return replace(
            batch,
            time_ns=np.array(times, np.int64),
            signal_index=np.array(indices, np.uint32),
            value=np.array(values, np.int64),
        )
