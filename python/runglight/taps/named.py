"""A tap whose signals are called by the names of a symbol table."""

from collections.abc import AsyncIterator, Mapping
from dataclasses import replace

from runglight.errors import InputError
from runglight.taps.base import Answer, Batch, Connection, Tap, TapSignal
from runglight.taps.s7_address import canonical_s7


class NamedTap(Tap):
    """Another tap, its signals renamed by address; those the table does not know keep their name.

    `names` is what `runglight.log.symbols.names_by_address` gives. Raises InputError where two
    signals get one name.
    """

    def __init__(self, tap: Tap, names: Mapping[str, str]) -> None:
        self._tap = tap
        self._names = names
        if tap.url.startswith("s7:"):
            # Tables exported from a German project say E and A.
            self._names = {canonical_s7(address): name for address, name in names.items()}
        self._renamed: list[TapSignal] = []
        self._known: set[str] = set()
        self.url = tap.url
        self.interval_ns = tap.interval_ns

    @property
    def signals(self) -> list[TapSignal]:  # type: ignore[override]
        """The renamed signals, as many as the tap has by now."""
        for signal in self._tap.signals[len(self._renamed) :]:
            named = self._named(signal)
            if named.name in self._known:
                raise InputError(
                    f"the symbol table gives two signals of {self.url} one name: {named.name}"
                )
            self._known.add(named.name)
            self._renamed.append(named)
        return self._renamed

    @property
    def connection(self) -> Connection:  # type: ignore[override]
        """The tap's connection."""
        return self._tap.connection

    async def __aiter__(self) -> AsyncIterator[Batch]:
        """The tap's batches as they are: indices stay."""
        async for batch in self._tap:
            yield batch

    async def check(self) -> list[Answer]:
        """The tap's answers, under the new names."""
        return [
            replace(answer, signal=self._named(answer.signal)) for answer in await self._tap.check()
        ]

    async def close(self) -> None:
        """Closes the tap."""
        await self._tap.close()

    async def __aenter__(self) -> "NamedTap":
        await self._tap.__aenter__()
        return self

    def _named(self, signal: TapSignal) -> TapSignal:
        return replace(signal, name=self._names.get(signal.address, signal.name))
