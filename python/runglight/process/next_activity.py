"""What comes next in a run, and how surely: a network over decay replay (DREAM-NAP)."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import msgspec

from runglight import _engine
from runglight.errors import InputError
from runglight.monitoring import MonitorVerbs
from runglight.process.event_log import EventLog
from runglight.process.petri_net import PetriNet

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from os import PathLike

UNLIKELY = 0.01
"""Probability below which an activity is told while watching."""


class TrainingSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """How a network is trained. The same seed gives the same network."""

    epochs: int = 500
    "Passes over the training part; at most so many with early stopping."
    batch: int = 64
    "Samples per step."
    learning_rate: float = 1e-3
    "Step size of Adam."
    seed: int = 0
    "Of weights, order of samples and dropout."
    patience: int | None = 20
    "Early stopping: end when the last fifth of the runs has not got better for so many epochs."


@dataclass(frozen=True)
class Accuracy:
    """How many events were foretold rightly."""

    right: int
    events: int

    @property
    def share(self) -> float:
        """Between 0 and 1; not a number where there was nothing to foretell."""
        return self.right / self.events if self.events else float("nan")

    def __add__(self, other: Accuracy) -> Accuracy:
        return Accuracy(self.right + other.right, self.events + other.events)


class NextActivity:
    """A trained network, with the net it was trained with."""

    def __init__(self, engine_next: _engine.NextActivity) -> None:
        self._engine = engine_next

    @property
    def engine(self) -> _engine.NextActivity:
        """The compiled engine's network."""
        return self._engine

    @property
    def activities(self) -> list[str]:
        """The activities it can foretell."""
        return self._engine.activities

    @property
    def training(self) -> dict[str, Any]:
        """`created`, `source`, `settings`, and `events`: how the log was cut into runs."""
        training: dict[str, Any] = json.loads(self._engine.training_json())
        return training

    def save(self, path: str | PathLike[str]) -> None:
        """Writes a directory with `next.json` and `network.safetensors`, as one."""
        self._engine.save(os.fspath(path))

    def foretell(self, log: EventLog, traces: Sequence[int] | None = None) -> dict[str, Any]:
        """How each event of some runs (None: all) was foretold, as numpy columns.

        `trace`, `event` (number of the event in its trace), `expected` (number of the most probable
        activity in `activities`), `came` (number of what came in `log.activities`), `probability`
        of what came, `right`. The opening of the next run is an event of it: `event` is 0 there.
        """
        columns = self._engine.foretell(log.engine, _all(log, traces))
        names = ("trace", "event", "expected", "came", "probability", "right")
        return dict(zip(names, columns, strict=True))

    def accuracy(self, log: EventLog, traces: Sequence[int] | None = None) -> Accuracy:
        """Events foretold rightly, of those that can be foretold."""
        right = self.foretell(log, traces)["right"]
        return Accuracy(int(right.sum()), len(right))

    def monitor(
        self, reset: str, *, unlikely: float = UNLIKELY, state: bytes | None = None
    ) -> NextMonitor:
        """A monitor at its start, or where another one's `state()` left off.

        An activity of a probability below `unlikely` becomes a finding of severity `notice`.
        """
        return NextMonitor(_engine.NextMonitor(self._engine, reset, unlikely, state))


class NextMonitor(MonitorVerbs[_engine.NextMonitor]):
    """Watches one machine, with the verbs of `runglight.Monitor`; all it tells are notices."""


def train_next(
    log: EventLog,
    net: PetriNet,
    settings: TrainingSettings | None = None,
    *,
    traces: Sequence[int] | None = None,
    progress: Callable[[int, float, float | None], object] | None = None,
    source: Sequence[str] = (),
    events: Mapping[str, Any] | None = None,
) -> NextActivity:
    """Trains a network on some runs of an event log (None: all).

    `progress(epoch, loss, held_out_loss)` is called after each epoch. `source` and `events` are
    kept with the network: where the log is from, and how it was cut into runs.
    """
    written = msgspec.json.encode(settings or TrainingSettings()).decode()
    return NextActivity(
        _engine.train_next(
            log.engine,
            net.engine,
            _all(log, traces),
            written,
            list(source),
            json.dumps(dict(events or {})),
            progress,
        )
    )


def load_next(path: str | PathLike[str], net: PetriNet, net_path: str = "") -> NextActivity:
    """Reads a trained network; raises ModelError where it is damaged or of another net."""
    return NextActivity(_engine.load_next(os.fspath(path), net.engine, net_path))


def decay_samples(
    log: EventLog, net: PetriNet, traces: Sequence[int] | None = None
) -> tuple[Any, Any]:
    """What a network is trained with: numpy features and the number of the activity that came.

    A row holds the decay, the counter and the tokens of each place just after the event before, not
    scaled: a float32 array of shape (samples, 3 * places).
    """
    return _engine.decay_samples(log.engine, net.engine, _all(log, traces))


def markov(log: EventLog, train: Sequence[int], test: Sequence[int], order: int) -> Accuracy:
    """What the network must beat: the activity that most often followed the last `order` ones.

    Order 0 is the commonest activity.
    """
    return Accuracy(*_engine.markov_score(log.engine, list(train), list(test), order))


def folds(traces: int, count: int) -> Iterator[tuple[list[int], list[int]]]:
    """Training and test part of each of `count` contiguous folds."""
    if traces < 2:
        raise InputError(f"folds: {traces} run is too few to hold some of them back; record more")
    if not 2 <= count <= traces:
        raise InputError(
            f"folds: {traces} runs make no {count} folds; give a number from 2 to {traces}"
        )
    for fold in range(count):
        start, end = traces * fold // count, traces * (fold + 1) // count
        test = list(range(start, end))
        yield [trace for trace in range(traces) if not start <= trace < end], test


def _all(log: EventLog, traces: Sequence[int] | None) -> list[int]:
    return list(range(log.traces)) if traces is None else list(traces)
