"""`runglight predict`: train a network on runs, and see how well it foretells."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import App, Parameter
from rich import box
from rich.table import Table

from runglight.cli import terminal
from runglight.cli.counted import counted
from runglight.cli.event_logs import RunOptions, read_runs
from runglight.cli.exit_codes import DONE
from runglight.cli.reader_options import ReaderOptions
from runglight.errors import InputError
from runglight.process.next_activity import (
    Accuracy,
    NextActivity,
    TrainingSettings,
    folds,
    load_next,
    markov,
    train_next,
)
from runglight.process.petri_net import PetriNet, read_net

if TYPE_CHECKING:
    from collections.abc import Sequence

    from runglight.process.event_log import EventLog

EPOCHS_AT_MOST = 500
PATIENCE = 20
FOLDS = 5

BASELINES = (("commonest activity", 0), ("after the last one", 1), ("after the last two", 2))

application = App(
    name="predict",
    help="Foretell the next activity of a run: train a network, and see how well it does.",
    help_format="markdown",
    default_parameter=Parameter(negative="", show_default=False),
)


@application.command
def train(
    log: Path,
    /,
    *,
    net: Path,
    output: Annotated[Path, Parameter(name=["--output", "-o"])],
    epochs: int | None = None,
    batch: int = 64,
    seed: int = 0,
    early_stopping: bool = False,
    runs: RunOptions | None = None,
    options: ReaderOptions | None = None,
) -> int:
    """Train a network that foretells the next activity of a run.

    Parameters
    ----------
    log: Path
        Log of fault-free operation.
    net: Path
        The net its runs follow (PNML), as `runglight mine` writes it.
    output: Path
        Directory to write the network to; one that is there is replaced.
    epochs: int
        Passes over the log (default: at most 500, with `--early-stopping`).
    batch: int
        Samples per step (default: 64).
    seed: int
        The same seed gives the same network (default: 0).
    early_stopping: bool
        Hold the last fifth of the runs out, and end when they are foretold no better; on where
        `--epochs` is not given.

    """
    runs = runs or RunOptions()
    event_log = read_runs(log, options or ReaderOptions(), runs)
    settings = _settings(epochs, batch, seed, early_stopping=early_stopping)
    mined = read_net(net)
    next_activity = _trained(event_log, mined, settings, source=[str(log)], events=runs.kept())
    next_activity.save(output)
    accuracy = next_activity.accuracy(event_log)
    console = terminal.results()
    console.print(
        f"{output}: trained on {counted(event_log.traces, 'run')}, "
        f"{counted(accuracy.events, 'event')} foretold, {_percent(accuracy)} of them rightly "
        "(on the runs it was trained on; see runglight predict evaluate)",
        markup=False,
        soft_wrap=True,
    )
    return DONE


@application.command
def evaluate(
    log: Path,
    /,
    *,
    net: Path,
    next: Path | None = None,
    folds: int | None = None,
    epochs: int | None = None,
    batch: int = 64,
    seed: int = 0,
    early_stopping: bool = False,
    runs: RunOptions | None = None,
    options: ReaderOptions | None = None,
) -> int:
    """Say how many events are foretold rightly, beside what needs no network.

    With `--next`, a trained network foretells a log; the baselines learn from that log itself.
    Without, the runs are cut into contiguous folds, and each is foretold by what was learned from
    the others.

    Parameters
    ----------
    log: Path
        Log to foretell.
    net: Path
        The net its runs follow (PNML).
    next: Path
        Network written by `runglight predict train`.
    folds: int
        Number of folds (default: 5).
    epochs: int
        Passes over the training part (default: at most 500, with `--early-stopping`).
    batch: int
        Samples per step (default: 64).
    seed: int
        The same seed gives the same numbers (default: 0).
    early_stopping: bool
        Hold the last fifth of each training part out, and end when it is foretold no better; on
        where `--epochs` is not given.

    """
    if next is not None and folds is not None:
        raise InputError("--folds: leave it out where --next names a network that is trained")
    mined = read_net(net)
    runs = runs or RunOptions()
    if next is not None:
        trained = load_next(next, mined, str(net))
        event_log = read_runs(
            log, options or ReaderOptions(), runs.over(trained.training["events"])
        )
        everything = range(event_log.traces)
        scores = [("network", trained.accuracy(event_log))]
        scores += [(name, markov(event_log, everything, everything, n)) for name, n in BASELINES]
        _print(f"{log}: {counted(event_log.traces, 'run')}", scores)
        return DONE
    event_log = read_runs(log, options or ReaderOptions(), runs)
    settings = _settings(epochs, batch, seed, early_stopping=early_stopping)
    count = FOLDS if folds is None else folds
    scores = _cross_validated(event_log, mined, settings, count)
    _print(f"{log}: {counted(event_log.traces, 'run')}, {count} folds", scores)
    return DONE


def _cross_validated(
    log: EventLog, net: PetriNet, settings: TrainingSettings, count: int
) -> list[tuple[str, Accuracy]]:
    scores = {name: Accuracy(0, 0) for name in ("network", *(name for name, _ in BASELINES))}
    for train, test in folds(log.traces, count):
        trained = _trained(log, net, settings, traces=train)
        scores["network"] += trained.accuracy(log, test)
        for name, order in BASELINES:
            scores[name] += markov(log, train, test, order)
    return list(scores.items())


def _settings(
    epochs: int | None, batch: int, seed: int, *, early_stopping: bool
) -> TrainingSettings:
    for name, number, least in (("epochs", epochs, 1), ("batch", batch, 1), ("seed", seed, 0)):
        if number is not None and number < least:
            raise InputError(f"--{name}: {number} must be at least {least}")
    return TrainingSettings(
        epochs=EPOCHS_AT_MOST if epochs is None else epochs,
        batch=batch,
        seed=seed,
        patience=PATIENCE if early_stopping or epochs is None else None,
    )


def _trained(log: EventLog, net: PetriNet, settings: TrainingSettings, **kept: Any) -> NextActivity:
    with terminal.progressing("Training", settings.epochs) as advance:
        return train_next(
            log, net, settings, progress=lambda _epoch, _loss, _held_out: advance(1), **kept
        )


def _print(title: str, scores: Sequence[tuple[str, Accuracy]]) -> None:
    table = Table(box=box.SIMPLE, title=title, title_justify="left")
    table.add_column("foretold by")
    for column in ("right", "events", "accuracy"):
        table.add_column(column, justify="right")
    for name, accuracy in scores:
        table.add_row(name, f"{accuracy.right:,}", f"{accuracy.events:,}", _percent(accuracy))
    terminal.results().print(table)


def _percent(accuracy: Accuracy) -> str:
    return f"{accuracy.share:.1%}".replace("%", " %") if accuracy.events else "—"
