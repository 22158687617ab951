"""Which number a tap's signals have in the recording."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from runglight.errors import InputError
from runglight.recording.description import Description, RecordedSignal, write_description
from runglight.taps.base import TapSignal


class Numbering:
    """Follows the growing list of a tap's signals; new ones are described before they are used."""

    def __init__(
        self, directory: Path, description: Description, signals: Sequence[TapSignal]
    ) -> None:
        self._directory = directory
        self._description = description
        self._known = {signal.name: at for at, signal in enumerate(description.signals)}
        self._numbers: list[int] = []
        self._taken: set[str] = set()
        for signal in signals:
            self._refuse_another(signal)
        self.numbers(signals)

    def numbers(self, signals: Sequence[TapSignal]) -> list[int]:
        """The recording's number of each of the tap's signals."""
        new = [_recorded(signal) for signal in signals[len(self._numbers) :]]
        for signal in new:
            if signal.name in self._taken:
                raise InputError(
                    f"{self._directory}: the source has two signals of one name: {signal.name}; "
                    "name them apart in the symbol table"
                )
            self._taken.add(signal.name)
        unknown = [signal for signal in new if signal.name not in self._known]
        if unknown:
            # On the disk before the first row that counts on it.
            self._description.signals = [*self._description.signals, *unknown]
            write_description(self._directory, self._description)
            for signal in unknown:
                self._known[signal.name] = len(self._known)
        self._numbers.extend(self._known[signal.name] for signal in new)
        return self._numbers

    @property
    def names(self) -> list[str]:
        """Names of the recording's signals, by number."""
        return [signal.name for signal in self._description.signals]

    def _refuse_another(self, signal: TapSignal) -> None:
        """One name must go on to mean one address."""
        number = self._known.get(signal.name)
        if number is None:
            return
        before = self._description.signals[number]
        if before.address != signal.address:
            raise InputError(
                f"{self._directory}: {signal.name} was recorded from {before.address} so far, and "
                f"now would be from {signal.address}; record to another directory"
            )


def _recorded(signal: TapSignal) -> RecordedSignal:
    return RecordedSignal(
        name=signal.name,
        address=signal.address,
        type=signal.type,
        signal_class=signal.signal_class,
        description=signal.description,
    )
